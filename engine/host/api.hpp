// The only includer of glew.h: OpenGL 4.3 core plus probed extensions, nothing newer (tests/unit/layers_test.cpp).
#pragma once

#include <GL/glew.h>

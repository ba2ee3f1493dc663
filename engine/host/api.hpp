// The only includer of glew.h: OpenGL 4.3 core plus probed extensions, nothing newer.
#pragma once

#include <GL/glew.h>

#include "host/newer_than_43.hpp"

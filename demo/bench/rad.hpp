// The benches of the radiosity original: it loads no scene, its models are made as they are needed.
#pragma once

#include "bench/bench.hpp"

#include <glm/glm.hpp>

#include <string>

namespace lucerna::demo::bench {

/// Tables 4.1 and 4.2, the number of sweeps, and what each deviation costs. scale: 0..1.
int runRadTables(const CommonOptions& common, double scale);

/// Pictures 3.10 to 3.18 and 4.1 to 4.6, as far as the three models show them, on one sheet. scale: 0..1, of the triangles and pixels.
int runRadPictures(const CommonOptions& common, const std::string& output, glm::ivec2 size, double scale);

}  // namespace lucerna::demo::bench

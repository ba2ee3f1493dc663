// The benches of the radiosity original. They load no scene: its models are generated as needed.
#pragma once

#include "originals/originals.hpp"

#include <glm/glm.hpp>

#include <string>

namespace lucerna::demo::bench {

/// Tables 4.1 and 4.2, the number of sweeps, and the cost of each deviation: notes and rows. scale: 0..1. prints: print
/// each line as soon as it is known. part: compute only that part; "rows_here" then holds the number of units it made.
nlohmann::ordered_json measureRadTables(const gl::Context& context, gl::ProgramLibrary& programs, double scale,
                                        bool quiet, bool prints, const PartOptions& part = {});
int runRadTables(const CommonOptions& common, double scale, const PartOptions& part);

/// Maps 3.5 to 3.8, pictures 3.10 to 3.18 and 4.1 to 4.6, as far as the three models can show them, on one sheet; empty
/// if interrupted. scale: 0..1, of the triangles and pixels.
VptSheet drawRadPictures(gl::ProgramLibrary& programs, glm::ivec2 size, double scale, bool quiet);
/// Progressive refinement after 1, 10, 100 and 1,000 shots beside the other methods after as many rows, on one sheet;
/// empty if interrupted. scale: 0..1, of the triangles.
VptSheet drawProgressivePictures(const gl::Context& context, gl::ProgramLibrary& programs, glm::ivec2 size,
                                 double scale, bool quiet);
/// Either sheet as a file.
int runRadPictures(const CommonOptions& common, const std::string& output, glm::ivec2 size, double scale,
                   bool progressive);

}  // namespace lucerna::demo::bench

// Marks the bricks that contain light of the first wavefront, and those next to its lit cells.
#include "cascades/block.glsl"
#include "lpv/bricks.glsl"
layout(local_size_x = GROUP_X, local_size_y = GROUP_Y, local_size_z = 1) in;
layout(binding = 0) uniform samplerBuffer wavefront;
uniform bool everywhere;  // all bricks, lit or not

void main() {
  ivec3 cell = ivec3(gl_GlobalInvocationID);
  int cells = grids.shape.x, layers = cells * grids.shape.y;
  if (any(greaterThanEqual(cell, ivec3(cells, cells, layers)))) return;
  int at = (cell.z * cells + cell.y) * cells + cell.x, channel = cells * cells * layers;
  bool dark = texelFetch(wavefront, at) == vec4(0.0) && texelFetch(wavefront, at + channel) == vec4(0.0) &&
              texelFetch(wavefront, at + 2 * channel) == vec4(0.0);
  if (dark && !everywhere) return;
  ivec3 local = ivec3(cell.xy, cell.z % cells);
  int ofAxis = bricksOfAxis();
  int brick = ((cell.z / cells * ofAxis + local.z / kBrick) * ofAxis + local.y / kBrick) * ofAxis + local.x / kBrick;
  bricks[brickCount() + brick] = 1u;
  markNeighbours(local, brick);
}

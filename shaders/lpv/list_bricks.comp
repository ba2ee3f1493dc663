// Appends newly marked bricks to the list, in any order: no cell's light depends on it.
#include "cascades/block.glsl"
#include "lpv/bricks.glsl"
layout(local_size_x = 64) in;

void main() {
  int brick = int(gl_GlobalInvocationID.x), all = brickCount();
  if (brick >= all || bricks[all + brick] == 0u || bricks[2 * all + brick] != 0u) return;
  bricks[2 * all + brick] = 1u;
  uint at = atomicAdd(count, 1u);
  bricks[at] = uint(brick);
  atomicMax(groups[1], at / kGroupsInRow + 1u);
}

// Bricks of 4^3 cells that light has reached. A propagation step is dispatched for these alone; all others stay zero.
//
// The lit cells of a wavefront mark the neighbouring bricks they touch. Between two steps lpv/list_bricks.comp appends
// newly marked bricks to the list. Bricks are never removed from the list, so a brick that is not on it has not been
// written since the buffers were cleared. Needs cascades/block.glsl.
const int kBrick = 4;

layout(std430, binding = 4) buffer Bricks {
  // of the next step's dispatch, one per brick, in rows of kGroupsInRow: an axis of a dispatch is limited to 65535
  // groups
  uint groups[3];
  uint count;
  uint bricks[];   // the list, then two flags per brick: reached, and listed
};
const uint kGroupsInRow = 64u;  // must match the engine's groups[0]

int bricksOfAxis() { return (grids.shape.x + kBrick - 1) / kBrick; }
int brickCount() { return bricksOfAxis() * bricksOfAxis() * bricksOfAxis() * grids.shape.y; }

// Marks the bricks next to its own that a lit cell of a cascade can reach.
void markNeighbours(ivec3 local, int brick) {
  int ofAxis = bricksOfAxis(), reached = brickCount() + brick, cells = grids.shape.x;
  ivec3 inBrick = local % kBrick;
  ivec3 way = ivec3(equal(inBrick, ivec3(kBrick - 1))) - ivec3(equal(inBrick, ivec3(0)));
  ivec3 beyond = local + way;
  if (way.x != 0 && uint(beyond.x) < uint(cells)) bricks[reached + way.x] = 1u;
  if (way.y != 0 && uint(beyond.y) < uint(cells)) bricks[reached + way.y * ofAxis] = 1u;
  if (way.z != 0 && uint(beyond.z) < uint(cells)) bricks[reached + way.z * ofAxis * ofAxis] = 1u;
}

// The bricks of 4^3 cells that light has reached: a propagation step is dispatched for these alone, all others stay
// zero.
//
// The lit cells of a front mark the neighbouring bricks that they touch; between two steps lpv/list_bricks.comp adds
// what is newly marked to the list. A brick that is on the list stays there: so a brick that is not has never been
// written since the buffers were cleared. Needs lpv/common.glsl.
const int kBrick = 4;

layout(std430, binding = 4) buffer Bricks {
  // of the next step's dispatch, one a brick, in rows of kGroupsInRow: a dispatch has 65535 along an axis
  uint groups[3];
  uint count;
  uint bricks[];   // the list; then one flag a brick: reached; then: listed
};
const uint kGroupsInRow = 64u;  // as the engine sets groups[0]

int bricksOfAxis() { return (lpv.shape.x + kBrick - 1) / kBrick; }
int brickCount() { return bricksOfAxis() * bricksOfAxis() * bricksOfAxis() * lpv.shape.y; }

// A cell of a cascade that holds light: what it reaches beyond its own brick.
void markNeighbours(ivec3 local, int brick) {
  int ofAxis = bricksOfAxis(), reached = brickCount() + brick, cells = lpv.shape.x;
  ivec3 inBrick = local % kBrick;
  ivec3 way = ivec3(equal(inBrick, ivec3(kBrick - 1))) - ivec3(equal(inBrick, ivec3(0)));
  ivec3 beyond = local + way;
  if (way.x != 0 && uint(beyond.x) < uint(cells)) bricks[reached + way.x] = 1u;
  if (way.y != 0 && uint(beyond.y) < uint(cells)) bricks[reached + way.y * ofAxis] = 1u;
  if (way.z != 0 && uint(beyond.z) < uint(cells)) bricks[reached + way.z * ofAxis * ofAxis] = 1u;
}

// Input of a slow frame: nothing is lost, and order is kept where it matters.
#include "host/input.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using lucerna::HostInput;
using lucerna::InputState;
using lucerna::MouseButton;
namespace key = lucerna::key;

std::vector<HostInput> stepsOf(InputState& state) {
  std::vector<HostInput> steps;
  while (state.waits()) steps.push_back(state.take());
  return steps;
}

void tap(InputState& state, int code) {
  state.key(code, true);
  state.key(code, false);
}

TEST(Input, ATapIsTwoSteps) {
  InputState state;
  tap(state, 'W');
  const std::vector<HostInput> steps = stepsOf(state);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].pressed, "W");
  EXPECT_EQ(steps[0].move.z, 1.0);
  EXPECT_EQ(steps[1].move.z, 0.0);
  EXPECT_FALSE(state.take().keys.size());
}

TEST(Input, FourTapsOfBackspaceAreFour) {
  InputState state;
  for (int i = 0; i < 4; ++i) tap(state, key::kBackspace);
  int downs = 0;
  for (const HostInput& step : stepsOf(state)) {
    ASSERT_LE(step.keys.size(), 1u);
    downs += !step.keys.empty() && step.keys[0].down;
  }
  EXPECT_EQ(downs, 4);
}

TEST(Input, AutomaticRepeatIsNoEvent) {
  InputState state;
  for (int i = 0; i < 10; ++i) state.key('A', true);
  EXPECT_EQ(stepsOf(state).size(), 1u);
}

TEST(Input, TextComesAfterTheClickAndAroundEditingKeys) {
  InputState state;
  state.cursor({10, 10});
  state.button(MouseButton::left, true);
  state.button(MouseButton::left, false);
  state.text("ab");
  tap(state, key::kBackspace);
  state.text("c");
  const std::vector<HostInput> steps = stepsOf(state);
  std::string order;
  for (const HostInput& step : steps) {
    EXPECT_TRUE(step.text.empty() || step.keys.empty() || !step.keys[0].down);
    if (step.buttons[0]) order += "press ";
    order += step.text;
    for (const lucerna::KeyEvent& event : step.keys)
      if (event.down) order += '<';
  }
  EXPECT_EQ(order, "press ab<c");
}

TEST(Input, TextComesAfterAnEditingKeyThatIsHeld) {
  InputState state;
  state.key(key::kBackspace, true);
  state.text("c");
  const std::vector<HostInput> steps = stepsOf(state);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].keys.size(), 1u);
  EXPECT_EQ(steps[0].text, "");
  EXPECT_EQ(steps[1].text, "c");
}

TEST(Input, TwoClicksKeepTheirPlaces) {
  InputState state;
  for (const double x : {10.0, 50.0}) {
    state.cursor({x, 5.0});
    state.button(MouseButton::left, true);
    state.button(MouseButton::left, false);
  }
  std::vector<double> places;
  for (const HostInput& step : stepsOf(state))
    if (step.buttons[0]) places.push_back(step.cursor.x);
  EXPECT_EQ(places, (std::vector<double>{10.0, 50.0}));
}

TEST(Input, ADragWithinAFrameMovesByAllOfIt) {
  InputState state;
  state.cursor({100, 100});
  state.button(MouseButton::middle, true);
  state.cursor({120, 100});
  state.cursor({160, 90});
  state.button(MouseButton::middle, false);
  glm::dvec2 moved(0.0);
  for (const HostInput& step : stepsOf(state))
    if (step.buttons[2]) moved += step.mouseDelta;
  EXPECT_EQ(moved, glm::dvec2(60.0, -10.0));
}

TEST(Input, TheWheelTurnsWhereTheCursorWas) {
  InputState state;
  state.cursor({10, 10});
  state.wheel({0.0, 1.0});
  state.wheel({0.0, 2.0});
  state.cursor({500, 10});
  const std::vector<HostInput> steps = stepsOf(state);
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].wheel.y, 3.0);
  EXPECT_EQ(steps[0].cursor.x, 10.0);
}

TEST(Input, EscapeStopsWorkAndNothingElse) {
  InputState state;
  tap(state, 'X');
  tap(state, key::kEscape);
  tap(state, 'I');
  EXPECT_TRUE(state.takeEscape());
  EXPECT_FALSE(state.takeEscape());
  std::string pressed;
  for (const HostInput& step : stepsOf(state)) {
    pressed += step.pressed;
    for (const lucerna::KeyEvent& event : step.keys) EXPECT_FALSE(event.key == key::kEscape && event.down);
  }
  EXPECT_EQ(pressed, "XI");
}

TEST(Input, ClosingIsSeenBeforeItsTurn) {
  InputState state;
  tap(state, 'X');
  EXPECT_FALSE(state.closes());
  state.close();
  EXPECT_TRUE(state.closes());
}

TEST(Input, LosingTheFocusReleasesAll) {
  InputState state;
  state.key('W', true);
  state.button(MouseButton::left, true);
  state.focus(false);
  HostInput last;
  for (const HostInput& step : stepsOf(state)) last = step;
  EXPECT_EQ(last.move, glm::dvec3(0.0));
  EXPECT_FALSE(last.buttons[0]);
  EXPECT_FALSE(last.focused);
  EXPECT_FALSE(state.take().focused);
}

}  // namespace

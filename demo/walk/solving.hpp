// A radiosity solution that is being made while the window goes on: how far it is, and how its residual falls.
#pragma once

#include "base/clock.hpp"
#include "radiosity/solution.hpp"
#include "walk/ui.hpp"

#include <string>
#include <vector>

namespace lucerna::demo {

class SolvingState {
 public:
  /// Forgets the curve of the solution before.
  void begin();
  void end() { isOn_ = false; }
  bool isOn() const { return isOn_; }
  /// What is being done, by a stage of the solution or in other words.
  void note(const RadiosityStage& stage);
  void note(const std::string& what);

  /// "form factors, 43 %, 12 s left".
  std::string text() const;
  double share() const { return share_; }  ///< of what is being done; negative: unknown

  /// The residual, max |E + rho F B - B| over the mean of B, by products with the matrix of form factors. A sweep or an
  /// iteration is one product, as are as many shots as there are patches.
  struct Point {
    double products, residual;
  };
  const std::vector<Point>& curve() const { return curve_; }

  bool cancelled = false;  ///< by the button or Escape

 private:
  void begin(const std::string& what);

  bool isOn_ = false;
  std::string what_;
  double share_ = -1.0, firstShare_ = 0.0;
  Clock::time_point start_;  ///< of what is being done
  std::vector<Point> curve_;
};

/// The box over the picture, while a solution is made.
void showSolving(Ui& ui, SolvingState& solving);
/// A plot of the curve, if there is one, in decades. Height in lines of text.
void plotResidual(const SolvingState& solving, float lines);

}  // namespace lucerna::demo

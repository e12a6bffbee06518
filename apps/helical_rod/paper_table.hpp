/// What the paper prints for the rod bent to helical shape.
#pragma once

#include <string>
#include <vector>

namespace mixbeam {

/// Tip position with 30 elements of an order, and its distance to 100 elements of order 5.
struct PaperRow {
  int order = 0;
  std::vector<std::string> position;  ///< r1(L), r2(L), r3(L)
  std::vector<std::string> error;     ///< e1, e2, e3
};

inline const std::string kPaperTable = "Humer, Steinbrecher, Pechstein, table of the rod bent to helical shape";
constexpr int kPaperElements = 30;

inline const std::vector<PaperRow>& paper_rows() {
  static const std::vector<PaperRow> rows = {
      {1, {"6.698e-03", "1.166e-04", "-1.249e-1"}, {"1.9e-03", "4.4e-05", "4.8e-02"}},
      {2, {"4.753e-03", "7.135e-05", "-7.789e-02"}, {"5.0e-05", "1.2e-06", "1.5e-03"}},
      {3, {"4.803e-03", "7.248e-05", "-7.647e-02"}, {"5.6e-07", "2.0e-08", "2.4e-05"}},
      {4, {"4.803e-03", "7.250e-05", "-7.644e-02"}, {"9.8e-09", "2.8e-10", "8.7e-08"}},
  };
  return rows;
}

}  // namespace mixbeam

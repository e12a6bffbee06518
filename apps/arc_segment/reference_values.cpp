#include "apps/arc_segment/reference_values.hpp"

#include "apps/common/tables/printed_digits.hpp"

namespace mixbeam {

namespace {

constexpr int kPrintedFigures = 6;  // the paper rounds its table to these

const std::vector<PaperRow> kRowsBeforeRounding = {
    {10, 1, 4, {"-23.75125", "-13.59944", "54.49189"}},    {10, 2, 4, {"-23.65101", "-13.63756", "54.08983"}},
    {10, 3, 4, {"-23.64497", "-13.63205", "54.095"}},      {10, 4, 4, {"-23.64501", "-13.63207", "54.09503"}},
    {10, 1, 32, {"-23.64685", "-13.63184", "54.10082"}},   {10, 2, 32, {"-23.64503", "-13.63208", "54.09503"}},
    {10, 3, 32, {"-23.64501", "-13.63207", "54.09503"}},   {10, 4, 32, {"-23.64501", "-13.63207", "54.09503"}},
    {100, 1, 4, {"-23.66304", "-13.57181", "53.87134"}},   {100, 2, 4, {"-23.56625", "-13.61001", "53.46957"}},
    {100, 3, 4, {"-23.5602", "-13.6045", "53.47483"}},     {100, 4, 4, {"-23.56024", "-13.60452", "53.47486"}},
    {100, 1, 32, {"-23.56202", "-13.60429", "53.48064"}},  {100, 2, 32, {"-23.56026", "-13.60453", "53.47486"}},
    {100, 3, 32, {"-23.56024", "-13.60452", "53.47486"}},  {100, 4, 32, {"-23.56024", "-13.60452", "53.47486"}},
    {1000, 1, 4, {"-23.66215", "-13.57153", "53.86514"}},  {1000, 2, 4, {"-23.56541", "-13.60974", "53.46337"}},
    {1000, 3, 4, {"-23.55935", "-13.60423", "53.46863"}},  {1000, 4, 4, {"-23.55939", "-13.60425", "53.46866"}},
    {1000, 1, 32, {"-23.56118", "-13.60401", "53.47444"}}, {1000, 2, 32, {"-23.55941", "-13.60426", "53.46866"}},
    {1000, 3, 32, {"-23.55939", "-13.60425", "53.46866"}}, {1000, 4, 32, {"-23.55939", "-13.60425", "53.46866"}},
};

}  // namespace

const std::string kPaperTable = "Humer, Steinbrecher, Pechstein, table of tip displacements of the arc-segment";

// The source has its centre at -e2: there u2 has the other sign.
const std::string kIndependentSource =
    "shooting on the rod ODE, Runge-Kutta 7(8), step doubling below 1e-10 (u2 mirrored: centre at +e2)";

const std::vector<PaperRow>& paper_table() {
  static const std::vector<PaperRow> rows = [] {
    std::vector<PaperRow> rounded = kRowsBeforeRounding;
    for (PaperRow& row : rounded)
      for (std::string& number : row.tip) number = rounded_to_figures(number, kPrintedFigures);
    return rounded;
  }();
  return rows;
}

const std::vector<IndependentValue>& independent_values() {
  static const std::vector<IndependentValue> values = {
      {"rho=10", 10, 1, false, false, {"-23.645012476468", "-13.632073912208", "54.095027011161"}},
      {"rho=100", 100, 1, false, false, {"-23.560239545026", "-13.604521347307", "53.474858791825"}},
      {"rho=100, 5 F", 100, 5, false, false, {"-47.686369893902", "-25.056445964830", "68.539089493083"}},
      {"rho=100, shear-rigid", 100, 1, true, false, {"-23.558527901019", "-13.603966104681", "53.471762953030"}},
      {"rho=100, rigid", 100, 1, true, true, {"-23.559383718350", "-13.604243719187", "53.468598442323"}},
      {"rho=10000", 1e4, 1, false, false, {"-23.559383803932", "-13.604243746950", "53.468599068354"}}};
  return values;
}

}  // namespace mixbeam

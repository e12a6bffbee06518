#include "apps/trade/choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace mixbeam {

namespace {

/// The difference of the references is an error of both; what is judged stands well above.
constexpr double kAboveReference = 10.0;

class GeometricMean {
 public:
  void add(double value) {
    sum_ += std::log(value);
    ++count_;
  }
  double value() const { return count_ == 0 ? std::numeric_limits<double>::quiet_NaN() : std::exp(sum_ / count_); }
  int count() const { return count_; }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

bool is_candidate(const CellResult& cell) {
  return cell.converged() && cell.cell.integration == ForceIntegration::both_reduced;
}

std::set<int> orders_of(const std::vector<BenchmarkResult>& results) {
  std::set<int> orders;
  for (const BenchmarkResult& result : results)
    for (const CellResult& cell : result.cells) orders.insert(cell.cell.order);
  return orders;
}

}  // namespace

double BenchmarkResult::floor() const {
  return kAboveReference * (problem.about.in_gallery ? motion_error(difference) : difference.largest());
}

double largest_error(const Errors& errors) { return errors.largest(); }
double displacement_error(const Errors& errors) { return errors.displacement; }
double motion_error(const Errors& errors) {
  return std::isnan(errors.displacement) ? errors.displacement : std::max(errors.displacement, errors.centerline);
}

CostMeasure processor_time(int threads) {
  return [threads](const CellResult& cell) { return cell.processor_seconds(threads); };
}
double operations(const CellResult& cell) { return cell.flops; }

std::vector<const CellResult*> pareto_front(const BenchmarkResult& result, const Criterion& by) {
  std::vector<const CellResult*> cells;
  for (const CellResult& cell : result.cells)
    if (is_candidate(cell)) cells.push_back(&cell);
  std::sort(cells.begin(), cells.end(),
            [&by](const CellResult* a, const CellResult* b) { return by.cost(*a) < by.cost(*b); });
  std::vector<const CellResult*> front;
  for (const CellResult* cell : cells)
    if (front.empty() || by.error(cell->errors) < by.error(front.back()->errors)) front.push_back(cell);
  return front;
}

const CellResult* cheapest(const BenchmarkResult& result, const Criterion& by, double accuracy, int order) {
  if (accuracy < result.floor()) return nullptr;
  const CellResult* best = nullptr;
  for (const CellResult& cell : result.cells) {
    if (!is_candidate(cell) || (order != 0 && cell.cell.order != order) || !(by.error(cell.errors) <= accuracy))
      continue;
    if (best == nullptr || by.cost(cell) < by.cost(*best)) best = &cell;
  }
  return best;
}

std::vector<OrderPrice> order_prices(const std::vector<BenchmarkResult>& results, const Criterion& by,
                                     double accuracy) {
  std::vector<OrderPrice> prices;
  for (const int order : orders_of(results)) {
    OrderPrice price;
    price.order = order;
    GeometricMean ratio, elements;
    for (const BenchmarkResult& result : results) {
      const CellResult* best = cheapest(result, by, accuracy);
      if (best == nullptr) continue;
      ++price.judged;
      const CellResult* of_order = cheapest(result, by, accuracy, order);
      if (of_order == nullptr) continue;
      ratio.add(by.cost(*of_order) / by.cost(*best));
      elements.add(of_order->cell.elements);
      price.worst = std::max(price.worst, by.cost(*of_order) / by.cost(*best));
    }
    price.reached = ratio.count();
    price.mean = ratio.value();
    price.elements = elements.value();
    prices.push_back(price);
  }
  return prices;
}

std::optional<OrderPrice> best_order(const std::vector<OrderPrice>& prices) {
  std::optional<OrderPrice> best;
  for (const OrderPrice& price : prices) {
    if (price.reached == 0) continue;
    if (!best || price.reached > best->reached || (price.reached == best->reached && price.mean < best->mean))
      best = price;
  }
  return best;
}

double cost_ratio(const std::vector<BenchmarkResult>& results, const Criterion& by, double accuracy, double coarse) {
  GeometricMean ratio;
  for (const BenchmarkResult& result : results) {
    const CellResult* fine = cheapest(result, by, accuracy);
    const CellResult* rough = cheapest(result, by, coarse);
    if (fine != nullptr && rough != nullptr) ratio.add(by.cost(*fine) / by.cost(*rough));
  }
  return ratio.value();
}

std::vector<double> accuracies() {
  std::vector<double> list;
  for (int digits = 2; digits <= 12; ++digits) list.push_back(std::pow(10.0, -digits));
  return list;
}

}  // namespace mixbeam

#include "apps/thread_scaling/measurement.hpp"

#include "apps/common/studies/study.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace mixbeam {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Sample, unit_factorize, unit_solve, unit_processor_seconds, phases)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Measurement, rounds, memory)

namespace {

constexpr std::array<const char*, 15> kOrderOfPhases = {"residual",
                                                        "element tangent",
                                                        "condense chains",
                                                        "assemble",
                                                        "symbolic factorisation",
                                                        "numeric factorisation",
                                                        "solve",
                                                        "check of the solve",
                                                        "recover",
                                                        "update",
                                                        kOther,
                                                        kElementWork,
                                                        kLinearSolver,
                                                        kLinearSolverSparse,
                                                        kWholeIteration};

/// Seconds of a phase; NaN if the round does not have it.
double seconds_of(const Round& round, int threads, const std::string& phase) {
  const auto sample = round.find(threads);
  if (sample == round.end() || sample->second.phases.count(phase) == 0) return std::nan("");
  return sample->second.phases.at(phase);
}

/// Median over the rounds, or over all their samples, in which `value` is a number.
template <class Value>
double over_rounds(const Measurement& measurement, const Value& value) {
  std::vector<double> values;
  for (const Round& round : measurement.rounds)
    if (const double found = value(round); !std::isnan(found)) values.push_back(found);
  return median(std::move(values));
}
template <class Value>
double over_samples(const Measurement& measurement, const Value& value) {
  std::vector<double> values;
  for (const Round& round : measurement.rounds)
    for (const auto& [threads, sample] : round) values.push_back(value(sample));
  return median(std::move(values));
}

}  // namespace

std::vector<std::string> Measurement::phases() const {
  std::set<std::string> names;
  for (const Round& round : rounds)
    for (const auto& [threads, sample] : round)
      for (const auto& [phase, seconds] : sample.phases) names.insert(phase);
  std::vector<std::string> ordered(names.begin(), names.end());
  const auto place = [](const std::string& phase) {
    return std::find(kOrderOfPhases.begin(), kOrderOfPhases.end(), phase) - kOrderOfPhases.begin();
  };
  std::stable_sort(ordered.begin(), ordered.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return ordered;
}

double Measurement::seconds(int threads, const std::string& phase) const {
  return over_rounds(*this, [&](const Round& round) { return seconds_of(round, threads, phase); });
}

double Measurement::ratio_to_unit(int threads, const std::string& phase) const {
  return over_rounds(*this, [&](const Round& round) {
    const double seconds = seconds_of(round, threads, phase);
    return std::isnan(seconds) ? seconds : seconds / round.at(threads).unit();
  });
}

double Measurement::speed_up(int reference_threads, int threads, const std::string& phase) const {
  return over_rounds(*this, [&](const Round& round) {
    const double seconds = seconds_of(round, threads, phase);
    return seconds > 0.0 ? seconds_of(round, reference_threads, phase) / seconds : std::nan("");
  });
}

double Measurement::unit() const {
  return over_samples(*this, [](const Sample& sample) { return sample.unit(); });
}

double Measurement::unit_factorize() const {
  return over_samples(*this, [](const Sample& sample) { return sample.unit_factorize; });
}

double Measurement::share_of_processor() const {
  return over_samples(*this, [](const Sample& sample) { return sample.unit_processor_seconds / sample.unit(); });
}

std::string written(const Measurement& measurement) {
  const std::vector<std::uint8_t> bytes = nlohmann::json::to_cbor(measurement);  // holds NaN too
  return {bytes.begin(), bytes.end()};
}

Measurement read_measurement(const std::string& bytes) { return nlohmann::json::from_cbor(bytes); }

}  // namespace mixbeam

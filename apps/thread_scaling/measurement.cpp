#include "apps/thread_scaling/measurement.hpp"

#include "apps/common/studies/study.hpp"

#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

namespace mixbeam {

namespace {

const double* find_phase(const Round& round, int threads, const std::string& phase) {
  const auto sample = round.find(threads);
  if (sample == round.end()) return nullptr;
  const auto entry = sample->second.phases.find(phase);
  return entry == sample->second.phases.end() ? nullptr : &entry->second;
}

template <class Value>
double median_over_samples(const Measurement& measurement, const Value& value) {
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
  return {names.begin(), names.end()};
}

double Measurement::seconds(int threads, const std::string& phase) const {
  std::vector<double> values;
  for (const Round& round : rounds)
    if (const double* found = find_phase(round, threads, phase)) values.push_back(*found);
  return median(std::move(values));
}

double Measurement::ratio_to_unit(int threads, const std::string& phase) const {
  std::vector<double> values;
  for (const Round& round : rounds)
    if (const double* found = find_phase(round, threads, phase)) values.push_back(*found / round.at(threads).unit());
  return median(std::move(values));
}

double Measurement::speed_up(int reference_threads, int threads, const std::string& phase) const {
  std::vector<double> values;
  for (const Round& round : rounds) {
    const double *reference = find_phase(round, reference_threads, phase), *found = find_phase(round, threads, phase);
    if (reference != nullptr && found != nullptr && *found > 0.0) values.push_back(*reference / *found);
  }
  return median(std::move(values));
}

double Measurement::unit() const {
  return median_over_samples(*this, [](const Sample& sample) { return sample.unit(); });
}
double Measurement::unit_factorize() const {
  return median_over_samples(*this, [](const Sample& sample) { return sample.unit_factorize; });
}

double Measurement::share_of_processor() const {
  return median_over_samples(*this, [](const Sample& sample) { return sample.unit_processor_seconds / sample.unit(); });
}

std::string written(const Measurement& measurement) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << "memory " << measurement.memory << "\n";
  for (const Round& round : measurement.rounds) {
    text << "round\n";
    for (const auto& [threads, sample] : round) {
      text << "sample " << threads << " " << sample.unit_factorize << " " << sample.unit_solve << " "
           << sample.unit_processor_seconds << "\n";
      for (const auto& [phase, seconds] : sample.phases) text << "phase " << seconds << " " << phase << "\n";
    }
  }
  return text.str();
}

Measurement read_measurement(const std::string& text) {
  Measurement measurement;
  Sample* sample = nullptr;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "memory") {
      std::string number;  // a stream does not read "nan"
      words >> number;
      measurement.memory = std::stod(number);
    } else if (kind == "round") {
      measurement.rounds.emplace_back();
    } else if (kind == "sample") {
      int threads = 0;
      words >> threads;
      sample = &measurement.rounds.at(measurement.rounds.size() - 1)[threads];
      words >> sample->unit_factorize >> sample->unit_solve >> sample->unit_processor_seconds;
    } else if (kind == "phase" && sample != nullptr) {
      double seconds = 0.0;
      std::string phase;
      words >> seconds >> std::ws;
      std::getline(words, phase);
      sample->phases[phase] = seconds;
    }
    if (words.fail()) throw std::runtime_error("not a measurement: " + line);
  }
  return measurement;
}

}  // namespace mixbeam

#include "apps/common/tables/csv_table.hpp"
#include "apps/common/tables/formatted.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "discretization/results/table_file.hpp"
#include "discretization/scene/load_cases.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/result_names.hpp"
#include "mixbeam/version.hpp"

#include <cmath>
#include <map>
#include <set>

namespace mixbeam {

namespace {

/// Envelope in the order of the scene; empty if fewer than two runs have quantities.
std::vector<QuantityEnvelope> envelope_of(const std::vector<FollowedQuantity>& quantities) {
  std::vector<QuantityEnvelope> envelope;
  std::map<std::string, std::size_t> index;
  std::set<std::string> runs;
  for (const FollowedQuantity& quantity : quantities) {
    runs.insert(quantity.run);
    const auto [found, is_new] = index.emplace(quantity.name, envelope.size());
    if (is_new) envelope.push_back({quantity.name, quantity.value, quantity.run, quantity.value, quantity.run});
    QuantityEnvelope& one = envelope[found->second];
    if (quantity.value > one.largest || std::isnan(one.largest)) {
      one.largest = quantity.value;
      one.largest_in = quantity.run;
    }
    if (quantity.value < one.smallest || std::isnan(one.smallest)) {
      one.smallest = quantity.value;
      one.smallest_in = quantity.run;
    }
  }
  if (runs.size() < 2) envelope.clear();
  return envelope;
}

/// Writes the values of every run beside the envelope, for pictures and reports. Layout: results.md.
void write_columns(const Application& app, const std::vector<FollowedQuantity>& quantities,
                   const std::filesystem::path& file) {
  const std::vector<QuantityEnvelope>& envelope = app.summary.envelope;
  std::map<std::string, std::size_t> index;  // of each run
  std::vector<std::vector<double>> values;
  std::string runs, names;
  for (const FollowedQuantity& quantity : quantities) {
    if (index.emplace(quantity.run, index.size()).second) {
      runs += quantity.run + "\n";
      values.emplace_back();
    }
    values[index[quantity.run]].push_back(quantity.value);
  }
  std::vector<TableColumn> columns = {{"largest", {}}, {"largest_in", {}}, {"smallest", {}}, {"smallest_in", {}}};
  for (const QuantityEnvelope& one : envelope) {
    names += one.name + "\n";
    columns[0].values.push_back(one.largest);
    columns[1].values.push_back(static_cast<double>(index[one.largest_in]));
    columns[2].values.push_back(one.smallest);
    columns[3].values.push_back(static_cast<double>(index[one.smallest_in]));
  }
  for (const auto& [run, i] : index) columns.push_back({"values/" + std::to_string(i), values[i]});
  write_table_file(file, columns,
                   {{"scene", app.xml.text}, {"version", kVersion}, {"quantities", names}, {kEnvelopeRuns, runs}},
                   kEnvelope);
}

/// Writes the envelope of these runs; nothing if fewer than two of them have quantities.
void write_envelope_of(Application& app, const std::vector<FollowedQuantity>& quantities,
                       const std::filesystem::path& file) {
  app.summary.envelope = envelope_of(quantities);
  if (app.summary.envelope.empty() || !app.writes_files()) return;
  write_columns(app, quantities, file);
  const std::filesystem::path csv = file.parent_path() / (file.stem().string() + "-envelope.csv");
  CsvTable table(csv, {"quantity", "largest", "largest in", "smallest", "smallest in"}, Appears::when_closed);
  app.out() << formatted("%-30s %18s %-20s %18s %s\n", "envelope of the ends", "largest", "in", "smallest", "in");
  constexpr std::size_t kMostPrinted = 30;  // the file has all
  std::size_t printed = 0;
  for (const QuantityEnvelope& one : app.summary.envelope) {
    table.add_row({one.name, one.largest, one.largest_in, one.smallest, one.smallest_in});
    if (++printed <= kMostPrinted)
      app.out() << formatted("%-30.60s %18.10g %-20.40s %18.10g %.40s\n", one.name.c_str(), one.largest,
                             one.largest_in.c_str(), one.smallest, one.smallest_in.c_str());
  }
  table.close();
  app.out() << "envelope: " << file.string() << ", " << csv.string() << "\n";
}

/// Quantities of the run that has just ended, or from its file. Throws InputError if they are not available.
std::vector<FollowedQuantity> quantities_of(const Application& app, const std::filesystem::path& file) {
  std::vector<FollowedQuantity> found;
  for (const FollowedQuantity& quantity : app.summary.quantities)
    if (quantity.run == file.stem().string()) found.push_back(quantity);
  if (!found.empty()) return found;
  const StoredRun run(file);
  const std::string name = file.filename().string();
  if (run.header().scene_xml != app.xml.text || run.header().imported != app.xml.source.files())
    throw InputError(name + " is of another scene");
  if (app.solver.analysis.control || run.steps().empty() || run.steps().back().load_factor != app.scene.stages)
    throw InputError("the run in " + name + " has not come to its end");
  const std::size_t last = run.steps().size() - 1, columns = app.quantities.columns().size();
  for (const MonitoredSeries& series : run.monitor()) {
    if (series.name != kQuantitySeries) continue;
    if (series.columns != columns) throw InputError("the quantities in " + name + " are not those of its scene");
    for (std::size_t i = 0; i < columns; ++i)
      if (const QuantitySet::Column& column = app.quantities.columns()[i]; column.is_value)
        found.push_back({file.stem().string(), column.name, series.values[last * columns + i]});
  }
  return found;
}

}  // namespace

void write_envelope(Application& app, const std::filesystem::path& file) {
  write_envelope_of(app, app.summary.quantities, file);
}

void renew_envelope(Application& app, const std::filesystem::path& file) {
  const std::vector<std::string> cases = alternatives(app.scene);
  if (cases.size() < 2 || app.quantities.empty()) return;
  const auto warn = [&](const std::string& reason) {
    app.warn(file.string() + ": the envelope is that of an earlier run: " + reason);
  };
  try {
    std::vector<FollowedQuantity> quantities;
    for (const std::string& load_case : cases)
      for (FollowedQuantity& one :
           quantities_of(app, result_file_of(file.parent_path(), file.stem().string(), load_case)))
        quantities.push_back(std::move(one));
    const SharedResultLock lock = lock_or_warn(app, file);
    write_envelope_of(app, quantities, file);
  } catch (const InputError& error) {
    if (std::filesystem::exists(file)) warn(error.what());  // otherwise no outdated envelope could mislead
  } catch (const ResultFileError& error) {
    warn(error.what());
  }
}

}  // namespace mixbeam

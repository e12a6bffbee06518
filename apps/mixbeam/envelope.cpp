#include "apps/common/tables/csv_table.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "apps/mixbeam/text_of.hpp"

#include <map>
#include <ostream>
#include <set>

namespace mixbeam {

namespace {

/// In the order of the scene; empty where fewer than two runs have quantities.
std::vector<QuantityEnvelope> envelope_of(const std::vector<FollowedQuantity>& quantities) {
  std::vector<QuantityEnvelope> envelope;
  std::map<std::string, std::size_t> index;
  std::set<std::string> runs;
  for (const FollowedQuantity& quantity : quantities) {
    runs.insert(quantity.run);
    const auto [found, is_new] = index.emplace(quantity.name, envelope.size());
    if (is_new) envelope.push_back({quantity.name, quantity.value, quantity.run, quantity.value, quantity.run});
    QuantityEnvelope& one = envelope[found->second];
    if (quantity.value > one.largest) {
      one.largest = quantity.value;
      one.largest_in = quantity.run;
    }
    if (quantity.value < one.smallest) {
      one.smallest = quantity.value;
      one.smallest_in = quantity.run;
    }
  }
  if (runs.size() < 2) envelope.clear();
  return envelope;
}

}  // namespace

void write_envelope(Application& app, const std::filesystem::path& file) {
  app.summary.envelope = envelope_of(app.summary.quantities);
  if (app.summary.envelope.empty() || !app.writes_files()) return;
  CsvTable table(file, {"quantity", "largest", "largest in", "smallest", "smallest in"}, Appears::when_closed);
  app.out() << text_of("%-30s %18s %-20s %18s %s\n", "envelope of the ends", "largest", "in", "smallest", "in");
  constexpr std::size_t kMostPrinted = 100;  // the file has them all
  std::size_t printed = 0;
  for (const QuantityEnvelope& one : app.summary.envelope) {
    table.add_row({one.name, one.largest, one.largest_in, one.smallest, one.smallest_in});
    if (++printed <= kMostPrinted)
      app.out() << text_of("%-30.60s %18.10g %-20.40s %18.10g %.40s\n", one.name.c_str(), one.largest,
                           one.largest_in.c_str(), one.smallest, one.smallest_in.c_str());
  }
  table.close();
  app.out() << "envelope: " << file.string() << "\n";
}

}  // namespace mixbeam

#include "apps/common/tables/csv_table.hpp"
#include "apps/mixbeam/scene_run.hpp"
#include "apps/mixbeam/text_of.hpp"

#include <ostream>
#include <set>

namespace mixbeam {

namespace {

struct Extremes {
  const FollowedQuantity *largest = nullptr, *smallest = nullptr;
};

}  // namespace

void write_envelope(const Application& app, const std::filesystem::path& file) {
  std::vector<std::string> names;  // in the order of the scene
  std::map<std::string, Extremes> envelope;
  std::set<std::string> runs;
  for (const FollowedQuantity& quantity : app.summary.quantities) {
    runs.insert(quantity.run);
    Extremes& extremes = envelope[quantity.name];
    if (extremes.largest == nullptr) {
      names.push_back(quantity.name);
      extremes = {&quantity, &quantity};
    }
    if (quantity.value > extremes.largest->value) extremes.largest = &quantity;
    if (quantity.value < extremes.smallest->value) extremes.smallest = &quantity;
  }
  if (runs.size() < 2 || !app.writes_files()) return;
  CsvTable table(file, {"quantity", "largest", "largest in", "smallest", "smallest in"}, Appears::when_closed);
  app.out() << text_of("%-30s %18s %-20s %18s %s\n", "envelope of the ends", "largest", "in", "smallest", "in");
  constexpr std::size_t kMostPrinted = 100;  // the file has them all
  for (std::size_t i = 0; i < names.size(); ++i) {
    const FollowedQuantity &high = *envelope[names[i]].largest, &low = *envelope[names[i]].smallest;
    table.add_row({names[i], high.value, high.run, low.value, low.run});
    if (i < kMostPrinted)
      app.out() << text_of("%-30.60s %18.10g %-20.40s %18.10g %.40s\n", names[i].c_str(), high.value, high.run.c_str(),
                           low.value, low.run.c_str());
  }
  table.close();
  app.out() << "envelope: " << file.string() << "\n";
}

}  // namespace mixbeam

/// Gradients of random structures, by paths in their files, against differences of whole runs.
#include "apps/common/run/scene_gradients.hpp"
#include "discretization/reading/variables.hpp"
#include "tests/problems/random_scenes.hpp"
#include "tests/support/scene_file.hpp"
#include "tests/support/solve.hpp"

#include <cstdlib>
#include <optional>

namespace mixbeam::test::gradients_test {
namespace {

constexpr std::uint64_t kSeed = 20251128;
constexpr int kScenes = 14, kNumbersPerScene = 2, kFewestCompared = 15;
/// Differences of eighth order with steps of half a percent: what Newton's method leaves of a quantity, over the step.
constexpr double kStep = 0.005, kStepOfPoint = 0.0002, kOfDifferences = 1e-8, kLeft = 1e-10, kRounding = 1e-12;

struct File {
  XmlParameters xml;
  Scene scene;
};

File file_of(const std::string& text) {
  File file{parsed(text), {}};
  file.scene = read_scene(file.xml.list->sublist("Scene"), file.xml.source);
  return file;
}

std::optional<Simulation> solution(const Scene& scene) {
  SolverParameters parameters;
  parameters.analysis.stability = false;
  parameters.load_path.maximum_steps = 12;
  Simulation simulation(scene, parameters, this_rank());
  if (!simulation.run().finished) return {};
  simulation.polish();
  return simulation;
}

std::vector<double> values_of(const QuantitySet& set, const Simulation& simulation) {
  const std::vector<Reaction> reactions = simulation.reactions();
  return set.values(
      {simulation.model(), simulation.state(), simulation.load_factor(), reactions, simulation.strain_energy()});
}

/// Everywhere and of everything that goes along.
QuantitySet quantities_of(const Scene& scene) {
  Teuchos::ParameterList list;
  list.sublist("u").set("Quantity", "displacement");
  list.sublist("u").set("Point", scene.points.back().name);
  list.sublist("theta").set("Quantity", "rotation");
  list.sublist("theta").set("Point", scene.members.front().name + "@40%");
  list.sublist("M").set("Quantity", "spatial moment");
  list.sublist("M").set("Point", scene.members.back().name + "@70%");
  list.sublist("N").set("Quantity", "material force");
  list.sublist("N").set("Component", "norm");
  list.sublist("N").set("Point", scene.members.front().name + "@70%");
  list.sublist("R").set("Quantity", "reaction force");
  list.sublist("R").set("Point", scene.supports.front().point);
  list.sublist("energy").set("Quantity", "strain energy");
  const ParameterSource source("scene.yaml");
  return QuantitySet(read_quantities(list, source), scene, {source, {"Quantities"}});
}

/// Of every column.
std::optional<std::vector<double>> differences(const std::string& text, const QuantitySet& set, const std::string& path,
                                               double shortest, double& step) {
  constexpr double kFactors[4] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  const std::size_t bracket = path.find('[');
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= std::min(bracket, path.size());) {
    const std::size_t end = std::min({path.find('/', begin), bracket, path.size()});
    names.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  const int component = bracket == std::string::npos ? -1 : std::atoi(path.c_str() + bracket + 1);
  std::vector<double> sum(set.columns().size(), 0.0);
  for (int k = 0; k < 4; ++k)
    for (const double sign : {1.0, -1.0}) {
      const XmlParameters xml = parsed(text);
      Teuchos::ParameterList* list = &xml.list->sublist("Scene");
      for (std::size_t i = 0; i + 1 < names.size(); ++i) list = &list->sublist(names[i]);
      Teuchos::ParameterEntry& entry = *list->getEntryPtr(names.back());
      double value = 0.0, size = 0.0;
      if (component < 0) {
        value = size = Teuchos::getValue<double>(entry);
      } else {
        for (const double one : Teuchos::getValue<Teuchos::Array<double>>(entry)) size = std::max(size, std::abs(one));
        value = Teuchos::getValue<Teuchos::Array<double>>(entry)[component];
      }
      step = names.front() == "Points" ? kStepOfPoint * shortest : kStep * std::abs(size);
      set_number(entry, component, value + sign * (k + 1) * step);
      const std::optional<Simulation> run = solution(read_scene(xml.list->sublist("Scene"), xml.source));
      if (!run) return {};
      const std::vector<double> values = values_of(set, *run);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += sign * kFactors[k] / step * values[i];
    }
  return sum;
}

/// Some numbers that are not zero.
std::vector<std::string> some_paths(const File& file, RandomNumbers& random) {
  std::vector<std::string> all;
  const Teuchos::ParameterList& scene = file.xml.list->sublist("Scene");
  for (const char* name : {"Sections", "Points", "Point Loads", "Distributed Loads", "Eigenstrains", "Supports"}) {
    if (!scene.isSublist(name)) continue;
    const Teuchos::ParameterList& list = scene.sublist(name);
    const auto add = [&](const std::string& path, const Teuchos::ParameterEntry& entry) {
      if (entry.isType<double>() && std::isfinite(Teuchos::getValue<double>(entry)) &&
          Teuchos::getValue<double>(entry) != 0.0)
        all.push_back(path);
      if (!entry.isType<Teuchos::Array<double>>() || path.find("Axis") != std::string::npos ||
          path.find("Axes") != std::string::npos)
        return;
      const auto& values = Teuchos::getValue<Teuchos::Array<double>>(entry);
      for (int i = 0; i < values.size(); ++i)
        if (values[i] != 0.0) all.push_back(path + "[" + std::to_string(i) + "]");
    };
    for (auto entry = list.begin(); entry != list.end(); ++entry) {
      const std::string path = std::string(name) + "/" + list.name(entry);
      if (!list.isSublist(list.name(entry))) {
        add(path, list.entry(entry));
        continue;
      }
      const Teuchos::ParameterList& one = list.sublist(list.name(entry));
      for (auto inner = one.begin(); inner != one.end(); ++inner)
        if (!one.isSublist(one.name(inner)) && !one.entry(inner).isDefault())
          add(path + "/" + one.name(inner), one.entry(inner));
    }
  }
  std::vector<std::string> chosen;
  for (int i = 0; i < kNumbersPerScene && !all.empty(); ++i)
    chosen.push_back(all[static_cast<std::size_t>(random.below(static_cast<int>(all.size())))]);
  return chosen;
}

TEST(RandomGradients, AreThoseOfDifferences) {
  int compared = 0;
  for (int number = 0; number < kScenes; ++number) {
    std::string text;
    std::optional<File> file;
    for (const bool with_joints : {true, false}) try {
        if (file) break;
        text = RandomSceneMaker(kSeed, number, with_joints).make().text;
        file = file_of(text);
      } catch (const InputError&) {
      }
    if (!file) continue;
    const std::optional<Simulation> simulation = solution(file->scene);
    if (!simulation) continue;
    const QuantitySet set = quantities_of(file->scene);
    const ResidualScales scales = scales_of(simulation->model(), simulation->state(), simulation->load_factor());
    const std::vector<double>& lengths = simulation->model().mesh().member_length;
    const double shortest = *std::min_element(lengths.begin(), lengths.end());
    const double length = simulation->model().structure().length;
    RandomNumbers random(kSeed + static_cast<std::uint64_t>(number));
    for (const std::string& path : some_paths(*file, random)) {
      RecordedGradients found;
      try {
        found = gradients_at(*simulation, {{"*"}, {path}, false}, {set, {}}, file->xml, "");
      } catch (const InputError&) {  // an arc through points of its own
        continue;
      } catch (const LinearSolverError&) {  // closed frames of rigid members
        continue;
      }
      ASSERT_EQ(found.numbers.size(), 1u) << path;
      double step = 0.0;
      const auto wanted = differences(text, set, path, shortest, step);
      if (!wanted) continue;
      ++compared;
      for (std::size_t i = 0; i < found.quantities.size(); ++i) {
        const double derivative = found.quantities[i].derivative[0];
        const double error = std::abs(derivative - (*wanted)[i]) * step;
        const double size = std::abs((*wanted)[i]) * step, value = std::abs(found.quantities[i].value);
        const char kind = found.quantities[i].quantity[0];
        const double scale = kind == 'u' ? length : kind == 't' ? 1.0 : kind == 'M' ? scales.moment : scales.force;
        const double allowed = kOfDifferences * size + kLeft * value + kRounding * scale;
        EXPECT_LE(error, allowed) << number << " " << path << " " << found.quantities[i].quantity << " " << derivative
                                  << " " << (*wanted)[i] << " value " << value;
      }
    }
  }
  EXPECT_GE(compared, kFewestCompared);
}

}  // namespace
}  // namespace mixbeam::test::gradients_test

// A result file that several ranks write together is the one that a single rank writes, and all ranks hear of an error
// on any of them.
#include "discretization/results/result_file.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/state/snapshot.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/files.hpp"
#include "tests/support/ranks.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <Teuchos_CommHelpers.hpp>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include <sys/resource.h>

namespace mixbeam::test {
namespace {

bool is_first_rank() { return all_ranks()->getRank() == 0; }
bool is_last_rank() { return all_ranks()->getRank() == all_ranks()->getSize() - 1; }

/// Added by the ranks behind the first to what they report.
std::string of_last_rank() {
  const int last = all_ranks()->getSize() - 1;
  return last == 0 ? "" : " (rank " + std::to_string(last) + ")";
}

/// Bytes of every dataset and attribute, by path.
using Contents = std::map<std::string, std::string>;

herr_t add_attribute(hid_t object, const char* name, const H5A_info_t*, void* of_object) {
  const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = H5Aget_type(attribute);
  std::string bytes(H5Aget_storage_size(attribute), '\0');
  H5Aread(attribute, type, bytes.data());
  (*static_cast<Contents*>(of_object))[name] = bytes;
  H5Tclose(type);
  H5Aclose(attribute);
  return 0;
}

std::string bytes_of_dataset(hid_t dataset) {
  const hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
  hsize_t shape[2] = {0, 0};
  H5Sget_simple_extent_dims(space, shape, nullptr);
  std::string bytes(static_cast<size_t>(H5Sget_simple_extent_npoints(space)) * H5Tget_size(type), '\0');
  H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  H5Sclose(space);
  H5Tclose(type);
  return std::to_string(shape[0]) + " x " + std::to_string(shape[1]) + ": " + bytes;
}

herr_t add_object(hid_t file, const char* name, const H5O_info_t* info, void* contents) {
  Contents& all = *static_cast<Contents*>(contents);
  const hid_t object = H5Oopen(file, name, H5P_DEFAULT);
  Contents attributes;
  H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, add_attribute, &attributes);
  for (const auto& [attribute, bytes] : attributes) all[std::string(name) + "@" + attribute] = bytes;
  all[name] = info->type == H5O_TYPE_DATASET ? bytes_of_dataset(object) : "group";
  H5Oclose(object);
  return 0;
}

Contents contents_of_results(const fs::path& path) {
  Contents contents;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, add_object, &contents, H5O_INFO_BASIC);
  H5Fclose(file);
  return contents;
}

std::vector<std::string> different_entries(const Contents& a, const Contents& b) {
  std::vector<std::string> names;
  for (const auto& [name, bytes] : a)
    if (b.count(name) == 0 || b.at(name) != bytes) names.push_back(name);
  for (const auto& [name, bytes] : b)
    if (a.count(name) == 0) names.push_back(name);
  return names;
}

/// The next representable number in place of one of a dataset.
void change_one_number(const fs::path& path, const std::string& dataset, size_t place) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
              id = H5Dopen2(file, dataset.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(id);
  std::vector<double> numbers(static_cast<size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
  numbers.at(place) = std::nextafter(numbers[place], HUGE_VAL);
  H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
  H5Sclose(space);
  H5Dclose(id);
  H5Fclose(file);
}

/// Unknowns drawn at random, the same on all ranks to the last bit, on all of them together or on each alone.
State random_state(const Scene& scene, const Model& model, unsigned seed) {
  const Model alone(scene, this_rank(), {});
  MixedVector increment = alone.create_vector();
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> entry(-0.1, 0.1);
  const auto vertex = increment.vertex();
  for (size_t i = 0; i < vertex.extent(0); ++i) vertex(i) = entry(generator);
  const auto interior = increment.writable_interior(false);
  for (size_t i = 0; i < interior.extent(0); ++i) interior(i) = entry(generator);
  return restore(model, snapshot_of(alone, alone.apply(alone.reference_state(), increment, 1.0)));
}

RecordedCriticalPoint critical_point(const StepRecord& record) {
  RecordedCriticalPoint point;
  point.kind = "bifurcation";
  point.load_factor = 0.25;
  for (const MemberSamples& member : record.members) {
    point.position.insert(point.position.end(), member.position.begin(), member.position.end());
    point.displacement.insert(point.displacement.end(), member.displacement.begin(), member.displacement.end());
    point.mode.insert(point.mode.end(), member.material_moment.begin(), member.material_moment.end());
  }
  point.monitored = record.monitored;
  point.state = record.state;
  return point;
}

/// Of step 0 to 3; together they have everything that a file can hold.
StepRecord record_of(const Scene& scene, const Model& model, int step) {
  const State state = random_state(scene, model, static_cast<unsigned>(step));
  StepRecord record;
  record.step = step;
  record.load_factor = 0.5 * step;
  record.members = sample_own_elements(scene, model, state, kPointsByOrder);
  record.monitored = {{"tip.displacement", {1.0 * step, 2, 3}}};
  record.reactions = {{"clamp", {1, 2, 3}, {4, 5, 1.0 * step}}};
  record.history = {{1, 0, 1.0}, {1, 1, 1e-15}};
  record.state = share_of(model, state);
  record.point.step = step;
  const RecordedCriticalPoint point = critical_point(record);
  if (step == 0) record.buckling = {{2.5, point.mode}, {3.5, point.displacement}};
  if (step == 1) record.critical_points = {point, point};
  if (step < 3) return record;
  record.error_estimate.emplace();
  for (int v = 0; v < model.mesh().vertices(); ++v)
    record.error_estimate->vertex_displacement.push_back({1.0 * v, 0.5, 1e-3 * v});
  for (size_t e = 0; e < model.mesh().elements.size(); ++e) {
    record.error_estimate->element_displacement.push_back(0.1 * static_cast<double>(e));
    record.error_estimate->element_moment.push_back(0.2 * static_cast<double>(e));
  }
  return record;
}

constexpr int kSteps = 4;

ResultHeader header_of_test() {
  return {"sample", "<ParameterList name=\"sample\"/>", "0.1.0", {{"compiler", "some"}}};
}

/// Stops half-way and resumes where `resumes`.
void write_results(const fs::path& path, const Scene& scene, const Communicator& communicator, bool resumes) {
  const Model model(scene, communicator, {});
  auto file = std::make_unique<ResultFile>(path, header_of_test(), communicator);
  for (int step = 0; step < kSteps; ++step) {
    if (resumes && step == 2) {
      file->close();
      file = std::make_unique<ResultFile>(StoredRun(path), communicator);
    }
    file->append_step(record_of(scene, model, step));
  }
  file->close();
}

/// A folder that all ranks see.
class MpiResultFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (fs::temp_directory_path() / "mixbeam_parallel_XXXXXX").string();
    if (is_first_rank()) {
      ASSERT_NE(mkdtemp(folder.data()), nullptr);
    }
    Teuchos::broadcast(*all_ranks(), 0, static_cast<int>(folder.size()), folder.data());
    folder_ = folder;
  }
  void TearDown() override {
    Teuchos::barrier(*all_ranks());
    if (is_first_rank()) fs::remove_all(folder_);
  }

  void expect_same_file(const Scene& scene, bool resumes = false) {
    write_results(folder_ / "together.h5", scene, all_ranks(), resumes);
    if (!is_first_rank()) return;
    write_results(folder_ / "alone.h5", scene, this_rank(), false);
    const Contents alone = contents_of_results(folder_ / "alone.h5");
    EXPECT_GT(alone.size(), 150U);
    EXPECT_EQ(different_entries(contents_of_results(folder_ / "together.h5"), alone), std::vector<std::string>());
    EXPECT_TRUE(resumes || text_of(folder_ / "together.h5") == text_of(folder_ / "alone.h5"));
    EXPECT_EQ(verify_results(folder_ / "together.h5").damage, "");
    change_one_number(folder_ / "together.h5", "/steps/000002/spatial_moment", 7);  // the twin that must fail
    EXPECT_EQ(different_entries(contents_of_results(folder_ / "together.h5"), alone),
              std::vector<std::string>{"steps/000002/spatial_moment"});
  }

  fs::path folder_;
};

Scene branched_scene() {
  Scene scene = fork(2, 5);
  scene.members[1].order = 4;
  return scene;
}

TEST_F(MpiResultFile, TheSameOnAnyNumberOfRanks) { expect_same_file(branched_scene()); }

// Fewer vertices than ranks: one of three ranks holds nothing.
TEST_F(MpiResultFile, RanksMayHoldNothing) { expect_same_file(arc_segment(100, 4, 1)); }

TEST_F(MpiResultFile, GoesOnBehindAStoredRun) { expect_same_file(branched_scene(), true); }

TEST_F(MpiResultFile, StatesComeBackOnAllRanks) {
  const Scene scene = branched_scene();
  write_results(folder_ / "run.h5", scene, all_ranks(), false);
  const Model alone(scene, this_rank(), {});
  const StateSnapshot expected = snapshot_of(alone, random_state(scene, alone, 3)),
                      stored = StoredRun(folder_ / "run.h5").state(3);
  EXPECT_EQ(stored.vertex_displacement, expected.vertex_displacement);
  EXPECT_EQ(stored.vertex_rotation, expected.vertex_rotation);
  EXPECT_EQ(stored.element_triad, expected.element_triad);
  EXPECT_EQ(stored.interior, expected.interior);
}

TEST_F(MpiResultFile, ARecordThatDoesNotFitOnOneRankIsRefusedByAll) {
  const Scene scene = branched_scene();
  const Model model(scene, all_ranks(), {});
  ResultFile file(folder_ / "run.h5", header_of_test(), all_ranks());
  StepRecord broken = record_of(scene, model, 0);
  if (is_last_rank()) broken.members[broken.members.size() - 1].position.pop_back();
  const std::string error = error_of<ResultFileError>([&] { file.append_step(broken); });
  EXPECT_NE(error.find("unequal length" + of_last_rank()), std::string::npos) << error;
  EXPECT_EQ(error_of<ResultFileError>([&] { file.append_step(record_of(scene, model, 0)); }), "no error");
}

// A limit on the file size stands for a full disk.
TEST_F(MpiResultFile, AFullDiskOnOneRankIsReportedByAll) {
  const Scene scene = branched_scene();
  const Model model(scene, all_ranks(), {});
  ResultFile file(folder_ / "run.h5", header_of_test(), all_ranks());
  file.append_step(record_of(scene, model, 0));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{40000, before.rlim_max};  // less than the file has with its first step
  if (is_last_rank()) setrlimit(RLIMIT_FSIZE, &limit);
  const std::string error = error_of<ResultFileError>([&] { file.append_step(record_of(scene, model, 1)); });
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_NE(error.find("File too large" + of_last_rank()), std::string::npos) << error;
  EXPECT_NE(
      error_of<ResultFileError>([&] { file.append_step(record_of(scene, model, 1)); }).find("takes no more steps"),
      std::string::npos);
  EXPECT_EQ(StoredRun(folder_ / "run.h5").steps().size(), 1U);  // the file keeps what it had
  EXPECT_FALSE(fs::exists(folder_ / ".run.h5.a"));
  EXPECT_FALSE(fs::exists(folder_ / ".run.h5.b"));
}

TEST_F(MpiResultFile, AMissingFolderIsReportedByAll) {
  const std::string error =
      error_of<ResultFileError>([&] { ResultFile(folder_ / "no" / "run.h5", header_of_test(), all_ranks()); });
  EXPECT_NE(error.find("does not exist"), std::string::npos) << error;
}

TEST(MpiRankAgreement, TheFirstProblemIsThatOfAll) {
  const Communicator ranks = all_ranks();
  EXPECT_EQ(first_problem(*ranks, [] {}), "");
  const auto fail = [] { throw std::runtime_error("disk full"); };
  EXPECT_EQ(first_problem(*ranks, fail), "disk full");
  EXPECT_EQ(first_problem(*ranks,
                          [&] {
                            if (is_last_rank()) fail();
                          }),
            "disk full" + of_last_rank());
}

}  // namespace
}  // namespace mixbeam::test

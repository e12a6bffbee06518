// A result file that several ranks write together is the one that a single rank writes, and all ranks hear of an error
// on any of them.
#include "discretization/results/result_file.hpp"
#include "discretization/state/sampling.hpp"
#include "discretization/state/snapshot.hpp"
#include "tests/support/constrained_scenes.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/hdf5.hpp"
#include "tests/support/ranks.hpp"
#include "tests/support/states.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <csignal>

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

/// The next representable number in place of one of a dataset.
void change_one_number(const fs::path& path, const std::string& dataset, size_t place) {
  std::vector<double> numbers = h5::numbers(path, dataset);
  numbers.at(place) = std::nextafter(numbers[place], HUGE_VAL);
  const hdf5::Handle file = h5::opened(path, H5F_ACC_RDWR);
  H5Dwrite(h5::dataset(file, dataset), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
}

/// Unknowns drawn at random, the same on all ranks to the last bit, on all of them together or on each alone.
State random_state(const Scene& scene, const Model& model, unsigned seed) {
  const Model alone(scene, this_rank(), {});
  MixedVector increment = alone.create_vector();
  fill_at_random(increment, 0.1, seed);
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
    const auto alone = contents_of(folder_ / "alone.h5", "");
    EXPECT_GT(alone.size(), 150U);
    EXPECT_EQ(differences(contents_of(folder_ / "together.h5", ""), alone), "");
    EXPECT_TRUE(resumes || text_of(folder_ / "together.h5") == text_of(folder_ / "alone.h5"));
    EXPECT_EQ(verify_results(folder_ / "together.h5").damage, "");
    change_one_number(folder_ / "together.h5", "/steps/000002/spatial_moment", 7);  // the twin that must fail
    EXPECT_EQ(differences(contents_of(folder_ / "together.h5", ""), alone), "steps/000002/spatial_moment differs\n");
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
  EXPECT_TRUE(same_bits(stored, expected));
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

/// Result files: what is written is read back with the HDF5 C API; a killed writer leaves a readable file; errors name
/// their reason.
#include "discretization/results/result_file.hpp"
#include "discretization/state/record_fields.hpp"

#include "discretization/text/errors.hpp"
#include "tests/support/child.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/hdf5.hpp"
#include "tests/support/text.hpp"

#include <functional>

namespace mixbeam {
namespace {

ResultHeader sample_header() { return {"sample", "<ParameterList name=\"sample\"/>", "0.1.0", {{"compiler", "some"}}}; }

class ResultFileTest : public ::testing::Test {
 protected:
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path(), file_ = folder_ / "run.h5";

  /// A whole file of these steps, in the order given.
  template <class... Records>
  void write(const Records&... records) {
    ResultFile result(file_, sample_header());
    (result.append_step(records), ...);
    result.close();
  }
  /// As a file of another version says of itself; the checksums are cut off.
  void change_version(int version) {
    const hdf5::Handle file = h5::opened(file_, H5F_ACC_RDWR);
    const hdf5::Handle attribute(H5Aopen(file, "format_version", H5P_DEFAULT), H5Aclose, "open");
    ASSERT_GE(H5Awrite(attribute, H5T_NATIVE_INT, &version), 0);
  }
};

constexpr int kBeforeChecksums = 2;

// Values that depend on every index, so that a swapped index shows.
Vector3 vector_of(int field, int member, std::size_t sample, int step) {
  Vector3 v{};
  for (std::size_t i = 0; i < 3; ++i) v[i] = 1000 * field + 100 * member + 10 * double(sample) + double(i) + 0.1 * step;
  return v;
}

MemberSamples sample_member(const std::string& name, int member, std::size_t samples, int step) {
  MemberSamples result;
  result.name = name;
  result.resize(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    result.arc_length[i] = 0.25 * double(i);
    result.element[i] = static_cast<int>(i / 2);
    result.reference_position[i] = vector_of(0, member, i, 0);
    result.position[i] = vector_of(1, member, i, step);
    result.displacement[i] = vector_of(2, member, i, step);
    result.force_strain[i] = vector_of(3, member, i, step);
    result.moment_strain[i] = vector_of(4, member, i, step);
    result.material_force[i] = vector_of(5, member, i, step);
    result.material_moment[i] = vector_of(6, member, i, step);
    result.triad[i] = {std::sqrt(0.5), 0, 0, std::sqrt(0.5)};  // quarter turn about e3: g1 = e2, g2 = -e1, g3 = e3
  }
  return result;
}

StepRecord sample_step(int step) {
  StepRecord record;
  record.step = step;
  record.load_factor = 0.1 * step;
  record.newton_iterations = 3 + step;
  record.residual = 1e-13;
  record.strain_energy = 2.5 * step;
  record.members = {sample_member("shaft", 0, 3, step), sample_member("tine", 1, 2, step)};
  record.monitored = {{"tip.displacement", {0.5 * step, 1, 2}}, {"reaction", {7.0 * step}}};
  return record;
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_F(ResultFileTest, FieldsComeBackConcatenatedOverMembers) {
  write(sample_step(0), sample_step(1), sample_step(2), sample_step(3));
  std::vector<hsize_t> shape;
  const auto position = h5::numbers(file_, "/steps/000003/position", &shape);
  EXPECT_EQ(shape, (std::vector<hsize_t>{5, 3}));
  for (std::size_t i = 0; i < 5; ++i) {
    const Vector3 expected = i < 3 ? vector_of(1, 0, i, 3) : vector_of(1, 1, i - 3, 3);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(position[3 * i + j], expected[j]);
  }
  EXPECT_EQ(h5::numbers(file_, "/steps/000002/material_moment")[4], vector_of(6, 0, 1, 2)[1]);
  EXPECT_EQ(h5::numbers(file_, "/members/reference_position")[3 * 3 + 5], vector_of(0, 1, 1, 0)[2]);
  EXPECT_EQ(h5::numbers(file_, "/members/element"), (std::vector<double>{0, 0, 1, 0, 0}));
  EXPECT_EQ(h5::numbers(file_, "/members/arc_length"), (std::vector<double>{0, 0.25, 0.5, 0, 0.25}));
  EXPECT_EQ(h5::numbers(file_, "/members/first_sample"), (std::vector<double>{0, 3}));
  EXPECT_EQ(h5::numbers(file_, "/members/samples"), (std::vector<double>{3, 2}));
  EXPECT_EQ(h5::numbers(file_, "/polyline/connectivity"), (std::vector<double>{2, 3, 0, 1, 2, 2, 2, 3, 4}));
}

// More rows than are collected for one write, in the copy that takes them from the record and in the other.
TEST_F(ResultFileTest, LongMembers) {
  constexpr std::size_t kSamples = 100000;
  static_assert(kSamples * sizeof(Vector3) > 2 * TableWriter::kBufferBytes);
  const auto long_step = [](int step) {
    StepRecord record = sample_step(step);
    record.members = {sample_member("shaft", 0, kSamples, step), sample_member("tine", 1, 2, step)};
    return record;
  };
  write(long_step(0), long_step(1));
  for (int step = 0; step < 2; ++step) {
    const auto position = h5::numbers(file_, "/steps/00000" + std::to_string(step) + "/position");
    ASSERT_EQ(position.size(), 3 * (kSamples + 2));
    for (std::size_t i = 0; i < kSamples + 2; ++i) {
      const Vector3 expected = i < kSamples ? vector_of(1, 0, i, step) : vector_of(1, 1, i - kSamples, step);
      for (std::size_t j = 0; j < 3; ++j)
        ASSERT_EQ(position[3 * i + j], expected[j]) << "step " << step << ", row " << i;
    }
  }
}

TEST_F(ResultFileTest, SpatialVectorsAreMaterialOnesTurnedByTheTriad) {
  write(sample_step(1));
  const auto moment = h5::numbers(file_, "/steps/000001/spatial_moment");
  const Vector3 material = vector_of(6, 0, 0, 1);
  EXPECT_NEAR(moment[0], -material[1], 1e-12 * 6000);  // rounding of values near 6000
  EXPECT_NEAR(moment[1], material[0], 1e-12 * 6000);
  EXPECT_NEAR(moment[2], material[2], 1e-12 * 6000);
  EXPECT_NEAR(h5::numbers(file_, "/steps/000001/triad_2")[0], -1.0, 1e-15);
}

TEST_F(ResultFileTest, StepsCarryAttributesAndTimeSeries) {
  ResultFile result(file_, sample_header());
  for (int step = 0; step < 200; ++step) result.append_step(sample_step(step));  // more than one chunk of a time series
  EXPECT_EQ(h5::number(file_, "/steps/000007", "load_factor"), 0.1 * 7);
  EXPECT_EQ(h5::number(file_, "/steps/000007", "newton_iterations"), 10);
  EXPECT_EQ(h5::number(file_, "/steps/000007", "residual"), 1e-13);
  std::vector<hsize_t> shape;
  const auto tip = h5::numbers(file_, "/monitor/tip.displacement", &shape);
  EXPECT_EQ(shape, (std::vector<hsize_t>{200, 3}));
  for (std::size_t step = 0; step < 200; ++step) EXPECT_EQ(tip[3 * step], 0.5 * double(step));
  EXPECT_EQ(h5::numbers(file_, "/monitor/reaction", &shape)[199], 7.0 * 199);
  EXPECT_EQ(shape, (std::vector<hsize_t>{200}));
}

StateSnapshot sample_state() { return {{1, 2, 3}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0.5, 0.25}}; }

/// A step behind a limit point, on a path that is followed by its length.
StepRecord step_behind_limit_point(int step) {
  StepRecord record = sample_step(step);
  record.stability = {"false", "true", 1, false};
  RecordedCriticalPoint point;
  point.kind = "limit point";
  point.load_factor = 0.75;
  point.load_factor_error = 2e-9;
  point.negative_after = 1;
  for (std::size_t i = 0; i < 5; ++i) {
    point.position.push_back(vector_of(1, 2, i, step));
    point.displacement.push_back(vector_of(2, 2, i, step));
    point.mode.push_back(vector_of(3, 2, i, step));
  }
  point.monitored = {{"tip.displacement", {4, 5, 6}}, {"reaction", {8}}};
  point.state = whole(sample_state());
  record.critical_points = {point};
  record.state = whole(sample_state());
  record.point.step = step;
  record.point.stage = 3;
  record.point.load_factor = record.load_factor;
  record.point.path_length = 0.125;
  record.point.direction = -1;
  record.point.negative = 1;
  record.point.branched = true;
  record.point.critical_points = 4;
  return record;
}

StepRecord step_on_path(int step) {
  StepRecord record = step_behind_limit_point(step);
  record.critical_points.clear();
  return record;
}

void expect_point(const PathPoint& point, int stage, double length, int direction, int negative, bool branched,
                  int critical_points) {
  EXPECT_EQ(point.stage, stage);
  EXPECT_EQ(point.path_length, length);
  EXPECT_EQ(point.direction, direction);
  EXPECT_EQ(point.negative, negative);
  EXPECT_EQ(point.branched, branched);
  EXPECT_EQ(point.critical_points, critical_points);
}

TEST_F(ResultFileTest, CriticalPointsStandInTheStepBehindThem) {
  write(sample_step(0), step_behind_limit_point(1));
  EXPECT_EQ(h5::number(file_, "/steps/000001", "negative_eigenvalues"), 1);
  const std::string point = "/steps/000001/critical_points/0";
  for (const auto& [name, value] : {std::pair("load_factor", 0.75),
                                    {"load_factor_error", 2e-9},
                                    {"negative_before", 0},
                                    {"negative_after", 1},
                                    {"modes", 1}})
    EXPECT_EQ(h5::number(file_, point, name), value) << name;
  std::vector<hsize_t> shape;
  for (const auto& [name, field] : {std::pair("position", 1), std::pair("displacement", 2), std::pair("mode", 3)}) {
    const std::vector<double> values = h5::numbers(file_, point + "/" + name, &shape);
    EXPECT_EQ(shape, (std::vector<hsize_t>{5, 3})) << name;
    ASSERT_EQ(values.size(), 15U);
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], vector_of(field, 2, i / 3, 1)[i % 3]) << name;
  }
  EXPECT_EQ(h5::numbers(file_, point + "/monitor/tip.displacement"), (std::vector<double>{4, 5, 6}));
}

TEST_F(ResultFileTest, ErrorEstimates) {
  StepRecord first = sample_step(1), second = sample_step(2);
  RecordedErrorEstimate estimate;
  estimate.vertex_displacement = {{1, 2, 3}, {4, 5, 6}};
  estimate.element_displacement = {0.5};
  estimate.element_moment = {0.25};
  estimate.moment = {1e-3, 2.0};
  estimate.energy = {-1e-4, 3.0};
  estimate.points = {{"tip", {4, 5, 6}}};
  estimate.quantities = {{"sag", -2.0, 0.125}, {"inside", 3.0, std::nan(""), "no formula"}};
  first.error_estimate = estimate;
  second.error_estimate = RecordedErrorEstimate{};
  second.error_estimate->not_estimated = "too coarse";
  write(first, second);
  const std::string group = "/steps/000001/error_estimate";
  EXPECT_EQ(h5::numbers(file_, group + "/vertex_displacement"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(h5::numbers(file_, group + "/element_moment"), std::vector<double>{0.25});
  EXPECT_EQ(h5::numbers(file_, group + "/points/tip"), (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(h5::numbers(file_, group + "/quantities/value"), (std::vector<double>{-2, 3}));
  EXPECT_EQ(h5::numbers(file_, group + "/quantities/error")[0], 0.125);
  EXPECT_TRUE(std::isnan(h5::numbers(file_, group + "/quantities/error")[1]));
  EXPECT_EQ(h5::text(file_, group + "/quantities/names"), "sag\ninside\n");
  EXPECT_EQ(h5::text(file_, group + "/quantities/not_estimated"), "\nno formula\n");
  EXPECT_EQ(h5::number(file_, group, "moment_size"), 2.0);
  EXPECT_EQ(h5::number(file_, group, "energy_error"), -1e-4);
  const auto contents = contents_of(file_);
  EXPECT_EQ(contents.count("steps/000002/error_estimate@not_estimated"), 1U);
  EXPECT_EQ(contents.count("steps/000002/error_estimate@energy_error"), 0U);
}

TEST_F(ResultFileTest, BucklingModesStandBesideTheSteps) {
  StepRecord first = sample_step(0);
  const std::vector<Vector3> mode = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {0, 0, 1}, {0, 1, 0}};
  first.buckling = {{2.5, mode}, {-3.5, std::vector<Vector3>(5)}};
  write(first, sample_step(1));  // in the other copy of the file
  EXPECT_EQ(h5::number(file_, "/buckling/0", "load_factor"), 2.5);
  EXPECT_EQ(h5::number(file_, "/buckling/1", "load_factor"), -3.5);
  EXPECT_EQ(h5::numbers(file_, "/buckling/0/mode"), (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 0, 1, 0, 1, 0}));
}

TEST_F(ResultFileTest, WhatResumingNeedsComesBack) {
  write(step_on_path(0), step_behind_limit_point(1));
  const StoredRun run(file_);
  expect_point(run.steps().at(1), 3, 0.125, -1, 1, true, 4);
  EXPECT_EQ(run.stability().at(1).stable, "false");
  EXPECT_EQ(run.stability().at(1).held, "true");
  EXPECT_EQ(run.stability().at(1).negative, 1);
  EXPECT_FALSE(run.stability().at(1).has_potential);
  EXPECT_TRUE(run.critical_points(0).empty());
  const std::vector<RecordedCriticalPoint> critical = run.critical_points(1);
  ASSERT_EQ(critical.size(), 1U);
  EXPECT_EQ(critical[0].kind, "limit point");
  EXPECT_EQ(critical[0].load_factor, 0.75);
  EXPECT_EQ(critical[0].load_factor_error, 2e-9);
  EXPECT_EQ(critical[0].state.held.interior, sample_state().interior);
}

template <class Record>
void expect_listed(const std::string& page) {
  std::apply(
      [&](const auto&... field) {
        for (const char* name : {field.name...})
          EXPECT_NE(page.find("`" + std::string(name) + "`"), std::string::npos) << name;
      },
      kFields<Record>);
}

TEST(ResultFields, ThePageNamesAll) {
  const std::string page = text_of(std::filesystem::path(MIXBEAM_SOURCE_DIR) / "apps/docs/results.md");
  expect_listed<StepSummary>(page);
  expect_listed<RecordedJump>(page);
  expect_listed<RecordedCriticalPoint>(page);
  expect_listed<RecordedBucklingMode>(page);
  expect_listed<RecordedVibrationMode>(page);
}

/// Files of versions that did not follow paths by their length lack its attributes.
TEST_F(ResultFileTest, OlderFilesAreRead) {
  StepRecord record = step_on_path(0);
  record.load_factor = record.point.load_factor = 1.5;
  write(record);
  {
    const hdf5::Handle file = h5::opened(file_, H5F_ACC_RDWR);
    for (const char* name : {"stage", "critical_points", "path_length", "direction", "negative", "branched"})
      ASSERT_GE(H5Adelete_by_name(file, "/steps/000000/state", name, H5P_DEFAULT), 0) << name;
    ASSERT_GE(H5Adelete_by_name(file, "/steps/000000", "stable", H5P_DEFAULT), 0);
  }
  change_version(kBeforeChecksums);
  EXPECT_EQ(StoredRun(file_).stability().at(0).stable, "unknown");
  expect_point(StoredRun(file_).steps().at(0), 2, 0.0, 1, -1, false, 0);
  {
    ResultFile result{StoredRun(file_)};
    record.step = 1;
    result.append_step(record);
  }
  const FileReport report = verify_results(file_);
  EXPECT_TRUE(report.is_sealed);
  EXPECT_EQ(report.damage, "");
  EXPECT_EQ(report.steps, (std::vector<int>{0, 1}));
}

/// A name as long as the table of names is wide ends without a zero.
TEST_F(ResultFileTest, NamesOfMembersComeBack) {
  StepRecord record = step_on_path(0);
  record.members[0].name = "a name that is longer than that of the other member, \xc3\xa4";
  write(record);
  {
    ResultFile goes_on{StoredRun(file_)};
    record.step = 1;
    goes_on.append_step(record);
    std::swap(record.members[0].name, record.members[1].name);
    record.step = 2;
    EXPECT_NE(error_of<ResultFileError>([&] { goes_on.append_step(record); }), "no error");
  }
  EXPECT_EQ(StoredRun(file_).steps().size(), 2u);
}

/// Before format 4 a member was a group, which might be called as a table is now.
TEST_F(ResultFileTest, GroupsOfMembersAreRead) {
  StepRecord record = step_on_path(0);
  record.members[0].name = "names";
  write(record);
  {
    const hdf5::Handle file = h5::opened(file_, H5F_ACC_RDWR);
    ASSERT_GE(H5Ldelete(file, "/members", H5P_DEFAULT), 0);
    const hdf5::Handle members = hdf5::create_group(file, "members");
    for (int index : {1, 0}) {
      const hdf5::Handle group = hdf5::create_group(members, index == 0 ? "names" : "tine");
      hdf5::write_attribute(group, "index", index);
      hdf5::write_attribute(group, "samples", index == 0 ? 3 : 2);
    }
  }
  change_version(kBeforeChecksums);
  ResultFile goes_on{StoredRun(file_)};
  record.step = 1;
  goes_on.append_step(record);
  record.step = 2;
  record.members[1].name = "another";
  EXPECT_NE(error_of<ResultFileError>([&] { goes_on.append_step(record); }), "no error");
}

TEST_F(ResultFileTest, NewerFormatsAreRefused) {
  write();
  change_version(99);
  expect_in(error_of<InputError>([&] { StoredRun{file_}; }), {"format_version is 99"});
}

TEST_F(ResultFileTest, SceneIsStoredWordForWord) {
  auto header = sample_header();
  header.scene_xml = std::string(100000, 'x') + "\n\xc3\xa4 end";  // larger than an HDF5 attribute can be
  ResultFile result(file_, header);
  EXPECT_EQ(h5::text(file_, "/scene"), header.scene_xml);
  EXPECT_EQ(h5::text(file_, "/version"), "0.1.0");
}

TEST_F(ResultFileTest, OnlyTheTwoFilesRemain) {
  write(sample_step(1));
  EXPECT_EQ(entries(folder_), 2u);
  expect_in(text_of(folder_ / "run.xdmf"), {"run.h5:/steps/000001/position", "</Xdmf>"});
}

TEST_F(ResultFileTest, XdmfListsEveryStepAfterClosing) {
  {
    ResultFile result(file_, sample_header());
    for (int step = 1; step <= 250; ++step) result.append_step(sample_step(step));
  }
  expect_in(text_of(folder_ / "run.xdmf"), {"run.h5:/steps/000250/position"});
}

TEST_F(ResultFileTest, KilledWriterLeavesEveryCompletedStep) {
  const pid_t child = started([&]() -> int {
    ResultFile result(file_, sample_header());
    for (int step = 1; step <= 3; ++step) result.append_step(sample_step(step));
    _exit(0);  // no destructor runs
  });
  ASSERT_EQ(end_of(child), 0);
  EXPECT_EQ(h5::numbers(file_, "/monitor/step"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(h5::numbers(file_, "/steps/000003/position").size(), 15u);
  expect_in(text_of(folder_ / "run.xdmf"), {"/steps/000003/"});
  write(sample_step(1));  // a new run starts afresh and clears what the killed one left
  EXPECT_EQ(h5::numbers(file_, "/monitor/step"), (std::vector<double>{1}));
  EXPECT_EQ(entries(folder_), 2u);
}

TEST_F(ResultFileTest, KillsAtAnyMomentLeaveAReadableFile) {
  constexpr int kKills = 25;
  constexpr useconds_t kDelayStep = 1700;  // [us]; no multiple of the time for a step, so that kills spread over it
  for (int kill_number = 0; kill_number < kKills; ++kill_number) {
    write();
    const pid_t child = started([&]() -> int {
      ResultFile result(file_, sample_header());
      for (int step = 1;; ++step) result.append_step(sample_step(step));
    });
    usleep(kDelayStep * static_cast<useconds_t>(kill_number + 1));
    kill(child, SIGKILL);
    end_of(child);
    ASSERT_EQ(h5::text(file_, "/version"), "0.1.0") << "kill " << kill_number;
    if (!fs::exists(folder_ / "run.xdmf")) continue;
    const auto steps = h5::numbers(file_, "/monitor/step");
    ASSERT_FALSE(steps.empty());
    std::string last = std::to_string(static_cast<int>(steps.back()));
    last.insert(0, 6 - last.size(), '0');
    ASSERT_EQ(h5::numbers(file_, "/steps/" + last + "/triad").size(), 20u) << "kill " << kill_number;
  }
}

TEST_F(ResultFileTest, UnwritablePathsAreNamedWithTheirReason) {
  std::ofstream(folder_ / "plain") << "text";
  const auto opened = [&](const fs::path& path) { return [=] { ResultFile(path, sample_header()); }; };
  expect_error<ResultFileError>(opened(folder_), {"is a directory"});
  expect_error<ResultFileError>(opened(folder_ / "no" / "run.h5"), {"no/run.h5", "does not exist"});
  expect_error<ResultFileError>(opened(folder_ / "plain" / "run.h5"), {"not a folder"});
  expect_error<ResultFileError>(opened("/proc/run.h5"), {"/proc/run.h5: cannot create the file: "});
  expect_error<ResultFileError>(opened(file_), {"no error"});  // the twin that must succeed
}

TEST_F(ResultFileTest, FullDiskIsReportedAndKeepsTheEarlierSteps) {
  const fs::path report = folder_ / "report";
  const pid_t child = started([&] {
    limit_file_size(500000);
    write_text(report, error_of<ResultFileError>([&] {
                 ResultFile result(file_, sample_header());
                 for (int step = 1; step < 1000; ++step) result.append_step(sample_step(step));
               }));
    return 0;
  });
  EXPECT_EQ(end_of(child), 0);
  expect_in(text_of(report), {"File too large"});
  EXPECT_GT(h5::numbers(file_, "/monitor/step").size(), 1u);
  EXPECT_FALSE(fs::exists(folder_ / ".run.h5.a"));
  EXPECT_FALSE(fs::exists(folder_ / ".run.h5.b"));
}

TEST_F(ResultFileTest, RecordsThatDoNotFitAreRefused) {
  ResultFile result(file_, sample_header());
  result.append_step(sample_step(1));
  const auto refuses = [&](StepRecord record, const std::string& reason,
                           const std::function<void(StepRecord&)>& spoil) {
    spoil(record);
    expect_error<ResultFileError>([&] { result.append_step(record); }, {reason});
  };
  const StepRecord step = sample_step(2);
  refuses(sample_step(1), "steps must grow", [](StepRecord&) {});
  refuses(step, "differ", [](StepRecord& other) { other.members[0] = sample_member("shaft", 0, 4, 2); });
  refuses(step, "unequal length", [](StepRecord& other) { other.members[1].position.pop_back(); });
  refuses(step_behind_limit_point(2), "unequal length",
          [](StepRecord& other) { other.critical_points[0].mode.pop_back(); });
  refuses(step, "cannot name a member", [](StepRecord& other) { other.members[1].name = "a/b"; });
  refuses(step, "cannot name a monitored", [](StepRecord& other) { other.monitored[1].name = "residual"; });
  refuses(step, "no error", [](StepRecord&) {});
}

}  // namespace
}  // namespace mixbeam

/// Result files: what is written is read back with the HDF5 C API; a killed writer leaves a readable file; errors name
/// their reason.
#include "discretization/results/result_file.hpp"
#include "discretization/state/record_fields.hpp"

#include "discretization/text/errors.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/files.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mixbeam {
namespace {

class ResultFileTest : public ::testing::Test {
 protected:
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path(), file_ = folder_ / "run.h5";
};

ResultHeader sample_header() { return {"sample", "<ParameterList name=\"sample\"/>", "0.1.0", {{"compiler", "some"}}}; }

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

std::vector<double> read_doubles(const fs::path& path, const std::string& name, std::vector<hsize_t>* shape = nullptr) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) return {};
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  const hid_t space = H5Dget_space(dataset);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  if (shape != nullptr) {
    shape->resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, shape->data(), nullptr);
  }
  H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(file);
  return values;
}

double read_number(const fs::path& path, const std::string& object, const std::string& attribute) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t id = H5Aopen_by_name(file, object.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  double value = std::nan("");
  H5Aread(id, H5T_NATIVE_DOUBLE, &value);
  H5Aclose(id);
  H5Fclose(file);
  return value;
}

std::string read_text(const fs::path& path, const std::string& name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
  const hid_t type = H5Dget_type(dataset);
  std::string text(H5Tget_size(type), ' ');
  H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data());
  H5Tclose(type);
  H5Dclose(dataset);
  H5Fclose(file);
  return text;
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_F(ResultFileTest, FieldsComeBackConcatenatedOverMembers) {
  ResultFile result(file_, sample_header());
  for (int step = 0; step < 4; ++step) result.append_step(sample_step(step));
  result.close();

  std::vector<hsize_t> shape;
  const auto position = read_doubles(file_, "/steps/000003/position", &shape);
  EXPECT_EQ(shape, (std::vector<hsize_t>{5, 3}));
  for (std::size_t i = 0; i < 5; ++i) {
    const Vector3 expected = i < 3 ? vector_of(1, 0, i, 3) : vector_of(1, 1, i - 3, 3);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_EQ(position[3 * i + j], expected[j]);
  }
  EXPECT_EQ(read_doubles(file_, "/steps/000002/material_moment")[4], vector_of(6, 0, 1, 2)[1]);
  EXPECT_EQ(read_doubles(file_, "/members/reference_position")[3 * 3 + 5], vector_of(0, 1, 1, 0)[2]);
  EXPECT_EQ(read_doubles(file_, "/members/element"), (std::vector<double>{0, 0, 1, 0, 0}));
  EXPECT_EQ(read_doubles(file_, "/members/arc_length"), (std::vector<double>{0, 0.25, 0.5, 0, 0.25}));
  EXPECT_EQ(read_doubles(file_, "/members/first_sample"), (std::vector<double>{0, 3}));
  EXPECT_EQ(read_doubles(file_, "/members/samples"), (std::vector<double>{3, 2}));
  EXPECT_EQ(read_doubles(file_, "/polyline/connectivity"), (std::vector<double>{2, 3, 0, 1, 2, 2, 2, 3, 4}));
}

// More rows than are collected for one write, in the copy that takes them from the record and in the other.
TEST_F(ResultFileTest, LongMembers) {
  constexpr std::size_t kSamples = 100000;
  static_assert(kSamples * sizeof(Vector3) > 2 * TableWriter::kBufferBytes);
  ResultFile result(file_, sample_header());
  StepRecord record = sample_step(0);
  for (int step = 0; step < 2; ++step) {
    record.step = step;
    record.members = {sample_member("shaft", 0, kSamples, step), sample_member("tine", 1, 2, step)};
    result.append_step(record);
  }
  result.close();
  for (int step = 0; step < 2; ++step) {
    const auto position = read_doubles(file_, "/steps/00000" + std::to_string(step) + "/position");
    ASSERT_EQ(position.size(), 3 * (kSamples + 2));
    for (std::size_t i = 0; i < kSamples + 2; ++i) {
      const Vector3 expected = i < kSamples ? vector_of(1, 0, i, step) : vector_of(1, 1, i - kSamples, step);
      for (std::size_t j = 0; j < 3; ++j)
        ASSERT_EQ(position[3 * i + j], expected[j]) << "step " << step << ", row " << i;
    }
  }
}

TEST_F(ResultFileTest, SpatialVectorsAreMaterialOnesTurnedByTheTriad) {
  ResultFile result(file_, sample_header());
  result.append_step(sample_step(1));
  const auto moment = read_doubles(file_, "/steps/000001/spatial_moment");
  const Vector3 material = vector_of(6, 0, 0, 1);
  EXPECT_NEAR(moment[0], -material[1], 1e-12 * 6000);  // rounding of values near 6000
  EXPECT_NEAR(moment[1], material[0], 1e-12 * 6000);
  EXPECT_NEAR(moment[2], material[2], 1e-12 * 6000);
  EXPECT_NEAR(read_doubles(file_, "/steps/000001/triad_2")[0], -1.0, 1e-15);
}

TEST_F(ResultFileTest, StepsCarryAttributesAndTimeSeries) {
  ResultFile result(file_, sample_header());
  for (int step = 0; step < 200; ++step) result.append_step(sample_step(step));  // more than one chunk of a time series
  EXPECT_EQ(read_number(file_, "/steps/000007", "load_factor"), 0.1 * 7);
  EXPECT_EQ(read_number(file_, "/steps/000007", "newton_iterations"), 10);
  EXPECT_EQ(read_number(file_, "/steps/000007", "residual"), 1e-13);
  std::vector<hsize_t> shape;
  const auto tip = read_doubles(file_, "/monitor/tip.displacement", &shape);
  EXPECT_EQ(shape, (std::vector<hsize_t>{200, 3}));
  for (std::size_t step = 0; step < 200; ++step) EXPECT_EQ(tip[3 * step], 0.5 * double(step));
  EXPECT_EQ(read_doubles(file_, "/monitor/reaction", &shape)[199], 7.0 * 199);
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

TEST_F(ResultFileTest, CriticalPointsStandInTheStepBehindThem) {
  ResultFile result(file_, sample_header());
  result.append_step(sample_step(0));
  result.append_step(step_behind_limit_point(1));
  result.close();
  EXPECT_EQ(read_number(file_, "/steps/000001", "negative_eigenvalues"), 1);
  const std::string point = "/steps/000001/critical_points/0";
  EXPECT_EQ(read_number(file_, point, "load_factor"), 0.75);
  EXPECT_EQ(read_number(file_, point, "load_factor_error"), 2e-9);
  EXPECT_EQ(read_number(file_, point, "negative_before"), 0);
  EXPECT_EQ(read_number(file_, point, "negative_after"), 1);
  EXPECT_EQ(read_number(file_, point, "modes"), 1);
  std::vector<hsize_t> shape;
  for (const auto& [name, field] : {std::pair("position", 1), std::pair("displacement", 2), std::pair("mode", 3)}) {
    const std::vector<double> values = read_doubles(file_, point + "/" + name, &shape);
    EXPECT_EQ(shape, (std::vector<hsize_t>{5, 3})) << name;
    ASSERT_EQ(values.size(), 15U);
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(values[i], vector_of(field, 2, i / 3, 1)[i % 3]) << name;
  }
  EXPECT_EQ(read_doubles(file_, point + "/monitor/tip.displacement"), (std::vector<double>{4, 5, 6}));
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
  {
    ResultFile file(file_, sample_header());
    file.append_step(first);
    file.append_step(second);
  }
  const std::string group = "/steps/000001/error_estimate";
  EXPECT_EQ(read_doubles(file_, group + "/vertex_displacement"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(read_doubles(file_, group + "/element_moment"), std::vector<double>{0.25});
  EXPECT_EQ(read_doubles(file_, group + "/points/tip"), (std::vector<double>{4, 5, 6}));
  EXPECT_EQ(read_doubles(file_, group + "/quantities/value"), (std::vector<double>{-2, 3}));
  EXPECT_EQ(read_doubles(file_, group + "/quantities/error")[0], 0.125);
  EXPECT_TRUE(std::isnan(read_doubles(file_, group + "/quantities/error")[1]));
  EXPECT_EQ(read_text(file_, group + "/quantities/names"), "sag\ninside\n");
  EXPECT_EQ(read_text(file_, group + "/quantities/not_estimated"), "\nno formula\n");
  EXPECT_EQ(read_number(file_, group, "moment_size"), 2.0);
  EXPECT_EQ(read_number(file_, group, "energy_error"), -1e-4);
  const hid_t file = H5Fopen(file_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t refused = H5Gopen2(file, "/steps/000002/error_estimate", H5P_DEFAULT);
  EXPECT_GT(H5Aexists(refused, "not_estimated"), 0);
  EXPECT_EQ(H5Aexists(refused, "energy_error"), 0);
  H5Gclose(refused);
  H5Fclose(file);
}

TEST_F(ResultFileTest, BucklingModesStandBesideTheSteps) {
  StepRecord first = sample_step(0);
  const std::vector<Vector3> mode = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {0, 0, 1}, {0, 1, 0}};
  first.buckling = {{2.5, mode}, {-3.5, std::vector<Vector3>(5)}};
  ResultFile result(file_, sample_header());
  result.append_step(first);
  result.append_step(sample_step(1));  // in the other copy of the file
  result.close();
  EXPECT_EQ(read_number(file_, "/buckling/0", "load_factor"), 2.5);
  EXPECT_EQ(read_number(file_, "/buckling/1", "load_factor"), -3.5);
  EXPECT_EQ(read_doubles(file_, "/buckling/0/mode"),
            (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 0, 1, 0, 1, 0}));
}

TEST_F(ResultFileTest, WhatResumingNeedsComesBack) {
  StepRecord first = step_behind_limit_point(0);
  first.critical_points.clear();
  const StepRecord last = step_behind_limit_point(1);
  ResultFile result(file_, sample_header());
  result.append_step(first);
  result.append_step(last);
  result.close();
  const StoredRun run(file_);
  const PathPoint point = run.steps().at(1);
  EXPECT_EQ(point.stage, 3);
  EXPECT_EQ(point.path_length, 0.125);
  EXPECT_EQ(point.direction, -1);
  EXPECT_EQ(point.negative, 1);
  EXPECT_TRUE(point.branched);
  EXPECT_EQ(point.critical_points, 4);
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
  StepRecord record = step_behind_limit_point(0);
  record.critical_points.clear();
  record.load_factor = record.point.load_factor = 1.5;
  ResultFile(file_, sample_header()).append_step(record);
  const hid_t file = H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t state = H5Gopen2(file, "/steps/000000/state", H5P_DEFAULT);
  for (const char* name : {"stage", "critical_points", "path_length", "direction", "negative", "branched"})
    ASSERT_GE(H5Adelete(state, name), 0) << name;
  H5Gclose(state);
  ASSERT_GE(H5Adelete_by_name(file, "/steps/000000", "stable", H5P_DEFAULT), 0);
  const hid_t version = H5Aopen(file, "format_version", H5P_DEFAULT);
  const int before_checksums = 2;
  ASSERT_GE(H5Awrite(version, H5T_NATIVE_INT, &before_checksums), 0);
  H5Aclose(version);
  H5Fclose(file);  // cuts the checksums off
  EXPECT_EQ(StoredRun(file_).stability().at(0).stable, "unknown");
  const PathPoint point = StoredRun(file_).steps().at(0);
  EXPECT_EQ(point.stage, 2);
  EXPECT_EQ(point.path_length, 0.0);
  EXPECT_EQ(point.direction, 1);
  EXPECT_EQ(point.negative, -1);
  EXPECT_FALSE(point.branched);
  EXPECT_EQ(point.critical_points, 0);
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
  StepRecord record = step_behind_limit_point(0);
  record.critical_points.clear();
  record.members[0].name = "a name that is longer than that of the other member, \xc3\xa4";
  { ResultFile(file_, sample_header()).append_step(record); }
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
  StepRecord record = step_behind_limit_point(0);
  record.critical_points.clear();
  record.members[0].name = "names";
  { ResultFile(file_, sample_header()).append_step(record); }
  const hid_t file = H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Ldelete(file, "/members", H5P_DEFAULT), 0);
  H5Gclose(H5Gcreate2(file, "/members", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  const hid_t space = H5Screate(H5S_SCALAR);
  for (int index : {1, 0}) {
    const hid_t group =
        H5Gcreate2(file, index == 0 ? "/members/names" : "/members/tine", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const int samples = index == 0 ? 3 : 2;
    for (const auto& [name, value] : {std::pair{"index", index}, std::pair{"samples", samples}}) {
      const hid_t attribute = H5Acreate2(group, name, H5T_STD_I32LE, space, H5P_DEFAULT, H5P_DEFAULT);
      H5Awrite(attribute, H5T_NATIVE_INT, &value);
      H5Aclose(attribute);
    }
    H5Gclose(group);
  }
  H5Sclose(space);
  const hid_t version = H5Aopen(file, "format_version", H5P_DEFAULT);
  const int before_checksums = 2;
  ASSERT_GE(H5Awrite(version, H5T_NATIVE_INT, &before_checksums), 0);
  H5Aclose(version);
  H5Fclose(file);
  ResultFile goes_on{StoredRun(file_)};
  record.step = 1;
  goes_on.append_step(record);
  record.step = 2;
  record.members[1].name = "another";
  EXPECT_NE(error_of<ResultFileError>([&] { goes_on.append_step(record); }), "no error");
}

TEST_F(ResultFileTest, NewerFormatsAreRefused) {
  { ResultFile result(file_, sample_header()); }
  const hid_t file = H5Fopen(file_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t version = H5Aopen(file, "format_version", H5P_DEFAULT);
  const int of_the_future = 99;
  ASSERT_GE(H5Awrite(version, H5T_NATIVE_INT, &of_the_future), 0);
  H5Aclose(version);
  H5Fclose(file);
  EXPECT_NE(error_of<InputError>([&] { StoredRun{file_}; }).find("format_version is 99"), std::string::npos);
}

TEST_F(ResultFileTest, SceneIsStoredWordForWord) {
  auto header = sample_header();
  header.scene_xml = std::string(100000, 'x') + "\n\xc3\xa4 end";  // larger than an HDF5 attribute can be
  ResultFile result(file_, header);
  EXPECT_EQ(read_text(file_, "/scene"), header.scene_xml);
  EXPECT_EQ(read_text(file_, "/version"), "0.1.0");
}

TEST_F(ResultFileTest, OnlyTheTwoFilesRemain) {
  {
    ResultFile result(file_, sample_header());
    result.append_step(sample_step(1));
  }
  EXPECT_EQ(entries(folder_), 2u);
  const auto text = text_of(folder_ / "run.xdmf");
  EXPECT_NE(text.find("run.h5:/steps/000001/position"), std::string::npos);
  EXPECT_NE(text.find("</Xdmf>"), std::string::npos);
}

TEST_F(ResultFileTest, XdmfListsEveryStepAfterClosing) {
  {
    ResultFile result(file_, sample_header());
    for (int step = 1; step <= 250; ++step) result.append_step(sample_step(step));
  }
  EXPECT_NE(text_of(folder_ / "run.xdmf").find("run.h5:/steps/000250/position"), std::string::npos);
}

TEST_F(ResultFileTest, KilledWriterLeavesEveryCompletedStep) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ResultFile result(file_, sample_header());
    for (int step = 1; step <= 3; ++step) result.append_step(sample_step(step));
    _exit(0);  // no destructor runs
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  EXPECT_EQ(read_doubles(file_, "/monitor/step"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(read_doubles(file_, "/steps/000003/position").size(), 15u);
  EXPECT_NE(text_of(folder_ / "run.xdmf").find("/steps/000003/"), std::string::npos);

  ResultFile again(file_, sample_header());  // a new run starts afresh and clears what the killed one left
  again.append_step(sample_step(1));
  again.close();
  EXPECT_EQ(read_doubles(file_, "/monitor/step"), (std::vector<double>{1}));
  EXPECT_EQ(entries(folder_), 2u);
}

TEST_F(ResultFileTest, KillsAtAnyMomentLeaveAReadableFile) {
  constexpr int kKills = 25;
  constexpr useconds_t kDelayStep =
      1700;  // microseconds; not a multiple of the time for a step, so kills spread over it
  for (int kill_number = 0; kill_number < kKills; ++kill_number) {
    { ResultFile empty(file_, sample_header()); }
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      ResultFile result(file_, sample_header());
      for (int step = 1;; ++step) result.append_step(sample_step(step));
    }
    usleep(kDelayStep * static_cast<useconds_t>(kill_number + 1));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    ASSERT_EQ(read_text(file_, "/version"), "0.1.0") << "kill " << kill_number;
    if (!fs::exists(folder_ / "run.xdmf")) continue;
    const auto steps = read_doubles(file_, "/monitor/step");
    ASSERT_FALSE(steps.empty());
    std::string last = std::to_string(static_cast<int>(steps.back()));
    last.insert(0, 6 - last.size(), '0');
    ASSERT_EQ(read_doubles(file_, "/steps/" + last + "/triad").size(), 20u) << "kill " << kill_number;
  }
}

TEST_F(ResultFileTest, UnwritablePathsAreNamedWithTheirReason) {
  EXPECT_NE(error_of<ResultFileError>([&] { ResultFile(folder_, sample_header()); }).find("is a directory"),
            std::string::npos);
  const auto missing = error_of<ResultFileError>([&] { ResultFile(folder_ / "no" / "run.h5", sample_header()); });
  EXPECT_NE(missing.find("no/run.h5"), std::string::npos);
  EXPECT_NE(missing.find("does not exist"), std::string::npos);
  std::ofstream(folder_ / "plain") << "text";
  EXPECT_NE(error_of<ResultFileError>([&] {
              ResultFile(folder_ / "plain" / "run.h5", sample_header());
            }).find("not a folder"),
            std::string::npos);
  EXPECT_NE(error_of<ResultFileError>([&] {
              ResultFile("/proc/run.h5", sample_header());
            }).find("/proc/run.h5: cannot create the file: "),
            std::string::npos);
  EXPECT_EQ(error_of<ResultFileError>([&] { ResultFile(file_, sample_header()); }),
            "no error");  // the twin that must succeed
}

// A limit on the file size stands for a full disk: both make write() fail in the middle of a step.
TEST_F(ResultFileTest, FullDiskIsReportedAndKeepsTheEarlierSteps) {
  const fs::path report = folder_ / "report";
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::ofstream report_stream(report);
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{500000, 500000};
    setrlimit(RLIMIT_FSIZE, &limit);
    report_stream << error_of<ResultFileError>([&] {
      ResultFile result(file_, sample_header());
      for (int step = 1; step < 1000; ++step) result.append_step(sample_step(step));
    });
    report_stream.close();
    std::exit(0);  // exit handlers of the HDF5 library run
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_NE(text_of(report).find("File too large"), std::string::npos) << text_of(report);
  EXPECT_GT(read_doubles(file_, "/monitor/step").size(), 1u);
  EXPECT_FALSE(fs::exists(folder_ / ".run.h5.a"));
  EXPECT_FALSE(fs::exists(folder_ / ".run.h5.b"));
}

TEST_F(ResultFileTest, RecordsThatDoNotFitAreRefused) {
  ResultFile result(file_, sample_header());
  result.append_step(sample_step(1));
  EXPECT_NE(error_of<ResultFileError>([&] { result.append_step(sample_step(1)); }).find("steps must grow"),
            std::string::npos);
  auto other = sample_step(2);
  other.members[0] = sample_member("shaft", 0, 4, 2);
  EXPECT_NE(error_of<ResultFileError>([&] { result.append_step(other); }).find("differ"), std::string::npos);
  other = sample_step(2);
  other.members[1].position.pop_back();
  EXPECT_NE(error_of<ResultFileError>([&] { result.append_step(other); }).find("unequal length"), std::string::npos);
  other = step_behind_limit_point(2);
  other.critical_points[0].mode.pop_back();
  EXPECT_NE(error_of<ResultFileError>([&] { result.append_step(other); }).find("unequal length"), std::string::npos);
  other = sample_step(2);
  other.members[1].name = "a/b";
  EXPECT_NE(error_of<ResultFileError>([&] { result.append_step(other); }).find("cannot name a member"),
            std::string::npos);
  other = sample_step(2);
  other.monitored[1].name = "residual";
  EXPECT_NE(error_of<ResultFileError>([&] { result.append_step(other); }).find("cannot name a monitored"),
            std::string::npos);
  EXPECT_EQ(error_of<ResultFileError>([&] { result.append_step(sample_step(2)); }), "no error");
}

}  // namespace
}  // namespace mixbeam

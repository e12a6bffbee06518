/// Damage of every kind is seen: flipped bits, zeroed and stale pages, cut files, and what is not damaged is read.
#include "discretization/results/guarded_file.hpp"
#include "discretization/results/published_file.hpp"
#include "discretization/results/result_file.hpp"
#include "discretization/results/table_file.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/child.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/hdf5.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <random>
#include <thread>

namespace mixbeam::seal_test {
namespace {

using Bytes = std::string;

constexpr std::size_t kPage = 4096;  // what a disk loses at a time

class Seals : public ::testing::Test {
 protected:
  /// Of the file, or why nothing is left of it.
  std::string damage() const {
    std::string found;
    const std::string error = error_of<InputError>([&] { found = verify_results(file_).damage; });
    return error == "no error" ? found : error;
  }
  Bytes read() const { return text_of(file_); }
  void write(const Bytes& bytes) const { write_text(file_, bytes); }
  /// Flips a bit in the byte behind the first place where these numbers stand one after the other.
  void damage_at(const std::vector<double>& numbers, std::size_t byte = 0) const {
    Bytes bytes = read();
    const std::size_t place =
        bytes.find(Bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)));
    ASSERT_NE(place, Bytes::npos);
    bytes[place + byte] ^= 1;
    write(bytes);
  }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path(), file_ = folder_ / "run.h5";
};

StepRecord step_of(int number, std::size_t samples) {
  StepRecord record;
  record.step = number;
  record.load_factor = 0.25 * number;
  MemberSamples member;
  member.name = "beam";
  member.resize(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    member.arc_length[i] = 0.5 * static_cast<double>(i);
    member.position[i] = {0.1 * static_cast<double>(i), 1.0 + number, 2.0};
    member.displacement[i] = {1.0 / (1.0 + static_cast<double>(i)), 0.5 * number, 3.0};
  }
  record.members = {member};
  record.monitored = {{"tip.displacement", {1.0, 2.0, 0.5 * number}}};
  StateSnapshot state;
  state.vertex_displacement = {1, 2, 3, 4, 5, 0.5 * number};
  state.vertex_rotation = {1, 0, 0, 0, 1, 0, 0, 0};
  state.element_triad = {1, 0, 0, 0};
  state.interior = {0.25, 0.5, 0.75};
  record.state = whole(state);
  record.point.step = number;
  record.point.step_size = 0.25;
  return record;
}

void write_run(const fs::path& file, int steps, std::size_t samples = 40) {
  ResultFile results(file, {"scene", "<ParameterList/>", "1", {{"program", "mixbeam"}}});
  for (int step = 1; step <= steps; ++step) results.append_step(step_of(step, samples));
  results.close();
}

/// Everything that resuming reads.
void read_run(const fs::path& file) {
  const StoredRun run(file);
  for (std::size_t i = 0; i < run.steps().size(); ++i) {
    run.state(i);
    run.critical_points(i);
  }
}

TEST_F(Seals, AWholeFileIsWhole) {
  write_run(file_, 3);
  const FileReport report = verify_results(file_);
  EXPECT_TRUE(report.is_sealed);
  EXPECT_EQ(report.damage, "");
  EXPECT_EQ(report.steps, (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(report.last_whole_step, 3);
  EXPECT_NO_THROW(read_run(file_));
}

TEST_F(Seals, DamageOfEveryKindIsSeen) {
  write_run(file_, 2);
  const Bytes earlier = read();
  write_run(file_, 3);
  const Bytes whole = read();
  std::mt19937 random(20261122);
  const auto below = [&](std::size_t end) { return std::uniform_int_distribution<std::size_t>(0, end - 1)(random); };
  const auto page_of = [&](Bytes& bytes, const std::function<char(std::size_t)>& value) {
    const std::size_t first = below(bytes.size() / kPage) * kPage;
    for (std::size_t i = first; i < std::min(first + kPage, bytes.size()); ++i) bytes[i] = value(i);
  };
  const std::vector<std::function<void(Bytes&)>> kinds = {
      [&](Bytes& bytes) { bytes[below(bytes.size())] ^= static_cast<char>(1 << below(8)); },
      [&](Bytes& bytes) { bytes.resize(below(bytes.size())); },
      [&](Bytes& bytes) { page_of(bytes, [](std::size_t) { return '\0'; }); },
      [&](Bytes& bytes) { page_of(bytes, [&](std::size_t i) { return i < earlier.size() ? earlier[i] : '\0'; }); },
      [&](Bytes& bytes) { page_of(bytes, [&](std::size_t i) { return whole[(i + kPage) % whole.size()]; }); }};
  constexpr int kEach = 60;
  int refused = 0, same = 0;
  for (std::size_t kind = 0; kind < kinds.size(); ++kind)
    for (int i = 0; i < kEach; ++i) {
      Bytes bytes = whole;
      kinds[kind](bytes);
      if (bytes == whole) {
        ++same;
        continue;
      }
      write(bytes);
      EXPECT_NE(damage(), "") << "kind " << kind << ", case " << i;
      ++refused;
    }
  EXPECT_GT(refused, 4 * kEach) << same << " pages were the same";
}

TEST_F(Seals, TheDamagedObjectIsNamedAndTheStepsBeforeItGoOn) {
  constexpr std::size_t kSamples = 4000;  // tables of many blocks
  constexpr double kMarker = 1.2345678901234567;
  {
    ResultFile results(file_, {"scene", "<ParameterList/>", "1", {{"program", "mixbeam"}}});
    for (int step = 1; step <= 3; ++step) {
      StepRecord record = step_of(step, kSamples);
      if (step == 2) record.members[0].material_force[kSamples / 2] = {kMarker, 0, 0};
      results.append_step(record);
    }
    results.close();
  }
  damage_at({kMarker});
  const FileReport report = verify_results(file_);
  EXPECT_NE(report.damage.find("/steps/000002/material_force"), std::string::npos) << report.damage;
  EXPECT_EQ(report.damage.find("/steps/000003"), std::string::npos) << report.damage;
  EXPECT_EQ(report.last_whole_step, 1);

  {
    const StoredRun run(file_, 1);
    EXPECT_EQ(run.steps().size(), 1u);
    ResultFile results(run);
    results.append_step(step_of(2, kSamples));
    results.append_step(step_of(3, kSamples));
    results.close();
  }
  const FileReport mended = verify_results(file_);
  EXPECT_EQ(mended.damage, "");
  EXPECT_EQ(mended.steps, (std::vector<int>{1, 2, 3}));
  EXPECT_THROW(StoredRun(file_, 7), InputError);
}

TEST_F(Seals, DamagedTimeSeriesLoseNoStep) {
  write_run(file_, 3, 4000);
  damage_at({1.0, 2.0, 0.5, 1.0, 2.0, 1.0});  // of tip.displacement
  const FileReport report = verify_results(file_);
  EXPECT_NE(report.damage.find("/monitor"), std::string::npos) << report.damage;
  ASSERT_TRUE(report.last_whole_step);
  EXPECT_THROW(StoredRun{file_}, InputError);
  StoredRun run(file_, *report.last_whole_step);
  EXPECT_FALSE(run.has_all_series());
  EXPECT_EQ(run.monitor().size(), 7u) << "those that steps have themselves";
  MonitoredSeries series{"tip.displacement", 3, {}};
  for (const PathPoint& step : run.steps()) series.values.insert(series.values.end(), {1.0, 2.0, 0.5 * step.step});
  run.complete({series});
  ResultFile results(run);
  for (int step = *report.last_whole_step + 1; step <= 4; ++step) results.append_step(step_of(step, 4000));
  results.close();
  EXPECT_EQ(verify_results(file_).damage, "");
  const StoredRun mended(file_);
  EXPECT_EQ(mended.steps().size(), 4u);
  for (const MonitoredSeries& of_run : mended.monitor())
    if (of_run.name == series.name) {
      EXPECT_EQ(of_run.values, (std::vector<double>{1.0, 2.0, 0.5, 1.0, 2.0, 1.0, 1.0, 2.0, 1.5, 1.0, 2.0, 2.0}));
    }
}

TEST_F(Seals, DamagedStatesAreNotResumedFrom) {
  write_run(file_, 2);
  const Bytes whole = read();
  damage_at({0.75}, 7);
  const Bytes bytes = read();
  EXPECT_THROW(read_run(file_), InputError);
  EXPECT_THROW(ResultFile{StoredRun(file_)}, std::exception);
  EXPECT_EQ(read(), bytes) << "the file is left as it is";
  EXPECT_EQ(files(), 2);
  write(whole);
  EXPECT_NO_THROW(read_run(file_));
}

/// The file was whole when it was looked at: what goes wrong now is met inside the HDF5 library.
TEST_F(Seals, DamageThatIsMetWhileCopyingIsAnError) {
  write_run(file_, 3);
  const StoredRun run(file_);
  const Bytes whole = read();
  std::size_t refused = 0, blocks = 0;
  for (std::size_t place = kPage / 2; place < whole.size(); place += kPage, ++blocks) {
    Bytes bytes = whole;
    bytes[place] ^= 1;
    write(bytes);
    const std::string error = error_of<ResultFileError>([&] { ResultFile{run}; });
    if (error == "no error") continue;
    EXPECT_NE(error.find("damaged"), std::string::npos) << error;
    EXPECT_EQ(read(), bytes) << "the file is left as it is";
    ++refused;
  }
  EXPECT_GT(refused, blocks / 2) << "of " << blocks << "; the others hold what is not copied";
}

/// What somebody can make of a file and seal anew.
struct Forgery {
  const char* reason;
  bool is_run_refused;  ///< by whatever reads the run; verifying refuses each one
  std::function<void(hid_t file)> forge;
};

void put_numbers(hid_t parent, const char* name, hid_t creation = H5P_DEFAULT) {
  const hsize_t three = 3;
  const hid_t space = H5Screate_simple(1, &three, nullptr);
  H5Dclose(H5Dcreate2(parent, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Sclose(space);
}

void put_attribute(hid_t file, const char* object, const char* name, hid_t type) {
  const hsize_t many = 400;
  const hid_t space = H5Screate_simple(1, &many, nullptr);
  H5Adelete_by_name(file, object, name, H5P_DEFAULT);
  const hid_t id = H5Acreate_by_name(file, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const std::vector<char> bytes(8 * many);
  EXPECT_GE(H5Awrite(id, type, bytes.data()), 0);
  H5Aclose(id);
  H5Sclose(space);
}

std::vector<Forgery> forgeries(const std::string& other_file) {
  const char* interior = "/steps/000001/state/interior";
  const auto without_interior = [=](hid_t file) { EXPECT_GE(H5Ldelete(file, interior, H5P_DEFAULT), 0); };
  return {{"it is not one value", true,
           [](hid_t file) { put_attribute(file, "/steps/000001/state", "stage", H5T_STD_I32LE); }},
          {"it is not one value", true, [](hid_t file) { put_attribute(file, "/", "format_version", H5T_STD_I32LE); }},
          {"it is not one text", true,
           [](hid_t file) {
             H5Ldelete(file, "/scene", H5P_DEFAULT);
             hdf5::write_texts(file, "scene", {"one", "two"});
           }},
          {"its values lie in another file", true,
           [=](hid_t file) {
             without_interior(file);
             const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
             H5Pset_external(creation, other_file.c_str(), 0, 3 * sizeof(double));
             put_numbers(file, interior, creation);
             H5Pclose(creation);
           }},
          {"it is a link that may leave the file", true,
           [=](hid_t file) {
             without_interior(file);
             H5Lcreate_soft("/steps/000002/state/interior", file, interior, H5P_DEFAULT, H5P_DEFAULT);
           }},
          {"it is a link that may leave the file", true,
           [=](hid_t file) {
             without_interior(file);
             H5Lcreate_external(other_file.c_str(), "/x", file, interior, H5P_DEFAULT, H5P_DEFAULT);
           }},
          {"it is in another place of the file too", false,
           [](hid_t file) { H5Lcreate_hard(file, "/polyline", file, "/polyline/itself", H5P_DEFAULT, H5P_DEFAULT); }},
          {"numbers that are not finite", true, [=](hid_t file) {
             const double values[3] = {0.25, std::nan(""), 0.75};
             const hdf5::Handle id = h5::dataset(file, interior);
             EXPECT_GE(H5Dwrite(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
           }}};
}

/// The seal says nothing about who has made a file.
void forge_and_seal(const fs::path& path, const std::function<void(hid_t file)>& forge) {
  forge(h5::opened(path, H5F_ACC_RDWR));
  DiskFile disk(path, DiskAccess::write);
  write_seal(disk, seal_of(disk, disk.size(), kSmallBlock));
}

TEST_F(Seals, ForgedFilesAreRefusedBeforeTheyAreRead) {
  const std::string other_file = folder_ / "other";
  write_text(other_file, std::string(1000, 'x'));
  write_run(file_, 2);
  const Bytes whole = read();
  forge_and_seal(file_, [](hid_t file) {  // the twin: what is as declared is read, whoever has written it
    H5Ldelete(file, "/steps/000001/state/interior", H5P_DEFAULT);
    hdf5::write_dataset(hdf5::Handle(H5Gopen2(file, "/steps/000001/state", H5P_DEFAULT), H5Gclose, "open"), "interior",
                        std::vector<double>{1.0, 2.0, 3.0}, 1);
  });
  EXPECT_EQ(verify_results(file_).damage, "");
  EXPECT_NO_THROW(read_run(file_));
  for (const Forgery& forgery : forgeries(other_file)) {
    write(whole);
    forge_and_seal(file_, forgery.forge);
    EXPECT_NE(damage().find(forgery.reason), std::string::npos) << forgery.reason << ": " << damage();
    if (forgery.is_run_refused) {
      EXPECT_THROW(read_run(file_), InputError) << forgery.reason;
    }
  }
}

TEST_F(Seals, WhatCannotBeReadIsNeverTakenForZeros) {
  write_run(file_, 3);
  SealedFile file(file_);
  fs::resize_file(file_, kPage);  // behind the back of whoever reads it
  char byte = 0;
  EXPECT_NO_THROW(file.content().read(10, &byte, 1));
  for (int again = 0; again < 2; ++again) {
    EXPECT_THROW(file.content().read(kPage + 10, &byte, 1), std::exception) << again;
  }
}

TEST_F(Seals, FilesWithoutSealAreRefusedUnlessTheirFormatHasNone) {
  write_run(file_, 1);
  Bytes bytes = read();
  bytes.resize(read_seal(DiskFile(file_, DiskAccess::read))->bytes);
  write(bytes);
  EXPECT_THROW(read_run(file_), InputError);
  EXPECT_THROW(verify_results(file_), InputError);
}

TEST_F(Seals, AnotherFileOfTheNameIsLeftAsItIs) {
  ResultFile results(file_, {"scene", "<ParameterList/>", "1", {}});
  results.append_step(step_of(1, 4));
  fs::rename(file_, folder_ / "kept.h5");
  write("of another program");
  EXPECT_THROW(results.append_step(step_of(2, 4)), ResultFileError);
  EXPECT_THROW(results.append_step(step_of(3, 4)), ResultFileError) << "takes no more steps";
  EXPECT_EQ(read(), "of another program");
  EXPECT_EQ(verify_results(folder_ / "kept.h5").steps, std::vector<int>{1});
}

TEST_F(Seals, ATableThatDoesNotFitLeavesTheEarlierOne) {
  const std::vector<TableColumn> small = {{"a/b", {1, 2, 3}}}, large = {{"a", std::vector<double>(100000, 0.5)}};
  write_table_file(file_, small, {{"scene", "text"}});
  EXPECT_EQ(verify_results(file_).damage, "");
  const Bytes before = read();
  const pid_t child = started([&] {
    limit_file_size(300000);
    const auto fails = [](const std::function<void()>& action) {
      return error_of<std::exception>(action).find("File too large") != std::string::npos ? 1 : 0;
    };
    return fails([&] { write_table_file(file_, large, {}); }) +
           fails([&] { replace_file(folder_ / "text", std::string(400000, 'x'), false); });
  });
  EXPECT_EQ(end_of(child), 2);
  EXPECT_EQ(read(), before);
  EXPECT_EQ(files(), 1);
}

TEST(SyncBudget, GuessesByBytesUntilItKnows) {
  constexpr std::uint64_t kGigabyte = 1'000'000'000;
  SyncBudget budget(false);
  EXPECT_FALSE(budget.affords(0)) << "nothing was computed yet";
  EXPECT_TRUE(SyncBudget(true).affords(kGigabyte)) << "every step waits";
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_TRUE(budget.affords(0));
  EXPECT_FALSE(budget.affords(kGigabyte)) << "seconds, after half a one";
  budget.spend([] {});
  EXPECT_TRUE(budget.affords(kGigabyte)) << "on a disk that takes no time";
}

TEST(RunningSum, OfPiecesIsThatOfTheWhole) {
  std::mt19937 random(20261122);
  Bytes bytes(10 * kSmallBlock + 100, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  std::uniform_int_distribution<std::size_t> length(1, 3 * kSmallBlock);
  for (int attempt = 0; attempt < 50; ++attempt) {
    RunningSums sums(kSmallBlock);
    const std::size_t begin = attempt % 3 == 0 ? 0 : length(random);
    for (std::size_t i = begin; i < bytes.size();) {
      const std::size_t part = std::min(length(random), bytes.size() - i);
      sums.add(i, bytes.data() + i, part);
      i += part;
    }
    const std::uint64_t first = (begin + kSmallBlock - 1) / kSmallBlock;
    ASSERT_EQ(sums.complete().size(), 10 - first);
    for (const BlockSum& known : sums.complete())
      EXPECT_EQ(known.sum, checksum(bytes.data() + known.block * kSmallBlock, kSmallBlock));
  }
  RunningSums gap(kSmallBlock);
  gap.add(0, bytes.data(), 100);
  gap.add(200, bytes.data() + 200, kSmallBlock);
  EXPECT_TRUE(gap.complete().empty()) << "a part of the block was not seen";
}

}  // namespace
}  // namespace mixbeam::seal_test

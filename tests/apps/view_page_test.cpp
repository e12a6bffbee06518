/// What the page of `mixbeam view` holds of a result: numbers, notes on what was left out, files that are no results.
#include "apps/mixbeam/view_page.hpp"

#include "discretization/text/errors.hpp"
#include "process.hpp"

#include <zlib.h>

namespace mixbeam::view_page_test {
namespace {

std::string inflated(const std::string& bytes, std::size_t size) {
  std::string result(size, '\0');
  z_stream stream{};
  inflateInit2(&stream, -MAX_WBITS);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  EXPECT_EQ(stream.total_out, size);
  inflateEnd(&stream);
  return result;
}

/// As viewer/packed.js does, without extrapolation.
std::vector<double> unpacked(const PackedNumbers& numbers, std::size_t count) {
  const std::size_t columns = numbers.units.size(), total = count * columns;
  const std::string bytes = inflated(numbers.bytes, 3 * total);
  std::vector<double> values(total);
  for (std::size_t c = 0; c < columns; ++c) {
    int rest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto byte = [&](std::size_t plane) {
        return static_cast<unsigned>(static_cast<unsigned char>(bytes[plane * total + c * count + i]));
      };
      const unsigned folded = byte(0) | byte(1) << 8 | byte(2) << 16;
      rest += static_cast<int>(folded >> 1) ^ -static_cast<int>(folded & 1);
      const int whole = static_cast<int>(static_cast<unsigned>(rest) << 8) >> 8;  // of 24 bits
      values[columns * i + c] = whole == 1 << 22 ? std::nan("") : whole * numbers.units[c];
    }
  }
  return values;
}

TEST(ViewPage, PackedNumbersKeepTheirDigits) {
  PageRows rows;
  rows.columns = 2;
  for (int i = 0; i < 200; ++i)
    rows.values.insert(rows.values.end(), {std::sin(0.1 * i), i == 7 ? std::nan("") : 1e6 - i});
  const PackedNumbers numbers = packed(rows, kForReading);
  const std::vector<double> read = unpacked(numbers, rows.count());
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (std::isnan(rows.values[i])) {
      EXPECT_TRUE(std::isnan(read[i]));
      continue;
    }
    const double unit = numbers.units[i % 2];
    EXPECT_LE(std::abs(read[i] - rows.values[i]), 0.500001 * unit);
    EXPECT_LE(unit, 1.0001 * (i % 2 == 0 ? 1.0 : 1e6) / 16383.0);
  }
  EXPECT_GT(std::abs(read[2] - rows.values[4]), numbers.units[0]);  // neighbours are told apart
}

TEST(ViewPage, TextsOfBase64) {  // RFC 4648
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

class PageOfAPath : public ::testing::Test {
 protected:
  void SetUp() override {
    const fs::path scene = fs::path(MIXBEAM_SOURCE_DIR) / "apps/gallery/snap_back.xml";
    output_of(kMixbeam + "run " + scene.string() + " --quiet --output " + folder_.path().string());
    result_ = folder_ / "snap_back.h5";
  }
  static bool notes(const ViewData& data, const std::string& text) {
    for (const auto& note : data.description["notes"])
      if (note.get<std::string>().find(text) != std::string::npos) return true;
    return false;
  }
  TemporaryFolder folder_;
  fs::path result_;
};

TEST_F(PageOfAPath, SaysWhatItLeavesOut) {
  const SampledFile run(result_.string());
  PageLimits limits;
  limits.samples = 12;
  const ViewData thin = view_data(run, {}, limits), whole = view_data(run);
  const auto samples = thin.description["samples"].get<std::size_t>();
  EXPECT_LE(samples, 12u);
  EXPECT_TRUE(notes(thin, std::to_string(samples) + " of " + std::to_string(run.samples()) + " samples"));
  EXPECT_EQ(whole.description["samples"].get<std::size_t>(), run.samples());
  EXPECT_FALSE(notes(whole, "samples"));
  const std::size_t count = run.steps().size();
  limits = {};
  limits.bytes = 0.0;
  limits.fewest_steps = 4;
  const ViewData short_path = view_data(run, {}, limits);
  ASSERT_EQ(short_path.description["steps"].size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(short_path.description["steps"][i]["place"].get<double>(),
              std::nearbyint(static_cast<double>(i * (count - 1)) / 3.0));
  EXPECT_TRUE(notes(short_path, "4 of " + std::to_string(count) + " steps are drawn; the load path has all."));
}

TEST_F(PageOfAPath, ReplacesNothingButPages) {
  const fs::path parts = fs::path(MIXBEAM_SOURCE_DIR) / "apps/plots/viewer", page = folder_ / "page.html";
  const std::string text = view_page({result_}, {}, parts);
  write_page(page, text);
  write_page(page, text);
  EXPECT_EQ(text_of(page), text);
  write_text(folder_ / "letter.html", "Dear Sir");
  for (const fs::path& other : {folder_ / "letter.html", result_}) {
    const std::string before = text_of(other);
    EXPECT_THROW(write_page(other, text), InputError);
    EXPECT_EQ(text_of(other), before);
  }
  EXPECT_THROW(view_page({folder_ / "letter.html"}, {}, parts), InputError);
  EXPECT_THROW(view_page({folder_ / "none.h5"}, {}, parts), InputError);
}

}  // namespace
}  // namespace mixbeam::view_page_test

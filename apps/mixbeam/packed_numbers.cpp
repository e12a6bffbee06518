#include "apps/mixbeam/view_page.hpp"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

namespace mixbeam {

namespace {

constexpr int kPlanes = 3;                  // bytes per number
constexpr std::int64_t kMissing = 1 << 22;  // stands for NaN
constexpr std::int64_t kHalf = 1 << 23;     // differences are taken modulo twice this
constexpr double kLeastUnit = 1e-300;
constexpr int kStrongest = 9;  // level and memory of zlib

double unit_of(const PageRows& rows, std::size_t column, int bits) {
  double largest = 0.0;
  for (std::size_t i = 0; i < rows.count(); ++i)
    if (const double value = rows.row(i)[column]; std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest > 0.0 ? std::max(largest / (std::exp2(bits - 1) - 1.0), kLeastUnit) : 1.0;
}

}  // namespace

PackedNumbers packed(const PageRows& rows, int bits, const PackedNumbers* later, const PackedNumbers* behind) {
  const std::size_t count = rows.count(), columns = rows.columns, total = count * columns;
  PackedNumbers result;
  result.values.resize(total);
  std::string planes(kPlanes * total, '\0');
  for (std::size_t c = 0; c < columns; ++c) {
    const double unit = unit_of(rows, c, bits);
    result.units.push_back(unit);
    std::int64_t before = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = columns * i + c;
      const double value = rows.values[at];
      const std::int64_t whole =
          std::isfinite(value) ? static_cast<std::int64_t>(std::floor(value / unit + 0.5)) : kMissing;
      result.values[at] = static_cast<double>(whole) * unit;
      std::int64_t expected = 0;
      if (later != nullptr) {
        const double ahead = behind != nullptr ? 2.0 * later->values[at] - behind->values[at] : later->values[at];
        const double limit = static_cast<double>(kMissing);
        expected = static_cast<std::int64_t>(std::clamp(std::floor(ahead / unit + 0.5), -limit, limit));
      }
      std::int64_t rest = whole - expected - before;
      before = whole - expected;
      rest = ((rest + kHalf) % (2 * kHalf) + 2 * kHalf) % (2 * kHalf) - kHalf;
      const std::int64_t folded = rest < 0 ? -2 * rest - 1 : 2 * rest;
      for (int plane = 0; plane < kPlanes; ++plane)
        planes[static_cast<std::size_t>(plane) * total + c * count + i] =
            static_cast<char>((folded >> (8 * plane)) & 255);
    }
  }
  result.bytes = deflated(planes);
  return result;
}

std::string deflated(const std::string& bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, kStrongest, Z_DEFLATED, -MAX_WBITS, kStrongest, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::string result(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  const int ended = deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  if (ended != Z_STREAM_END) throw std::runtime_error("zlib could not deflate the numbers of a page");
  return result;
}

std::string base64(const std::string& bytes) {
  constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string code;
  code.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) code += i + k > bytes.size() ? '=' : kLetters[three >> (18 - 6 * k) & 63u];
  }
  return code;
}

}  // namespace mixbeam

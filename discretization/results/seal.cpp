#include "discretization/results/seal.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#define XXH_INLINE_ALL  // with the instructions of this machine
#include <xxhash.h>

namespace mixbeam {

namespace {

constexpr std::array<char, 16> kMagic = {'m', 'i', 'x', 'b', 'e', 'a', 'm', ' ', 's', 'e', 'a', 'l', ' ', '1', 0, 0};

/// The last bytes of a sealed file.
struct SealEnd {
  std::uint64_t bytes = 0, block = 0;
  std::uint64_t sum = 0;  ///< of the list and the two numbers above
  std::array<char, 16> magic = kMagic;
};

std::uint64_t sum_of_list(const Seal& seal) {
  const std::array<std::uint64_t, 3> parts = {checksum(seal.sums.data(), 8 * seal.sums.size()), seal.bytes, seal.block};
  return checksum(parts.data(), sizeof parts);
}

bool is_block_size(std::uint64_t bytes) { return bytes == kSmallBlock || bytes == kLargeBlock; }

XXH3_state_t& of(void* state) { return *static_cast<XXH3_state_t*>(state); }

}  // namespace

std::uint64_t checksum(const void* bytes, std::size_t count) { return XXH3_64bits(bytes, count); }

std::size_t Seal::bytes_of(std::uint64_t number) const { return std::min(block, bytes - number * block); }

std::uint64_t Seal::bytes_behind() const { return 8 * blocks() + sizeof(SealEnd); }

void Seal::resize(std::uint64_t new_bytes) {
  bytes = new_bytes;
  if (blocks() == sums.size()) return;
  const std::vector<char> zeros(block, 0);
  sums.resize(blocks(), checksum(zeros.data(), zeros.size()));
}

bool Seal::holds(std::uint64_t number, const void* block_bytes) const {
  return number < sums.size() && sums[number] == checksum(block_bytes, block);
}

std::vector<BlockSum> Seal::all() const {
  std::vector<BlockSum> list;
  for (std::uint64_t i = 0; i < sums.size(); ++i) list.push_back({i, sums[i]});
  return list;
}

std::string text_of_damage(std::uint64_t first, std::uint64_t end) {
  return "bytes " + std::to_string(first) + " to " + std::to_string(end - 1) + " are damaged";
}

std::optional<Seal> read_seal(const DiskFile& file) {
  const std::uint64_t size = file.size();
  SealEnd end;
  if (size < sizeof end) return {};
  file.read(size - sizeof end, &end, sizeof end);
  if (end.magic != kMagic) return {};
  const std::uint64_t list = size - sizeof end;
  Seal seal{end.bytes, end.block, {}};
  const bool fits = is_block_size(end.block) && end.bytes <= list && list - end.bytes == 8 * seal.blocks();
  if (fits) {
    seal.sums.resize(seal.blocks());
    file.read(end.bytes, seal.sums.data(), 8 * seal.sums.size());
  }
  if (!fits || sum_of_list(seal) != end.sum)
    throw DamageError("the list of checksums after its content is damaged, or the file was truncated");
  return seal;
}

void write_seal(DiskFile& file, const Seal& seal) {
  SealEnd end;
  end.bytes = seal.bytes;
  end.block = seal.block;
  end.sum = sum_of_list(seal);
  std::vector<char> behind(seal.bytes_behind());
  std::memcpy(behind.data(), seal.sums.data(), 8 * seal.sums.size());
  std::memcpy(behind.data() + 8 * seal.sums.size(), &end, sizeof end);
  file.write(seal.bytes, behind.data(), behind.size());
  file.resize(seal.bytes + behind.size());
}

void read_block(const DiskFile& file, const Seal& seal, std::uint64_t number, std::byte* bytes) {
  const std::size_t count = seal.bytes_of(number);
  file.read(number * seal.block, bytes, count);
  std::fill(bytes + count, bytes + seal.block, std::byte{0});
}

Seal seal_of(const DiskFile& file, std::uint64_t bytes, std::uint64_t block) {
  Seal seal{bytes, block, {}};
  std::vector<std::byte> buffer(block);
  for (std::uint64_t i = 0; i < seal.blocks(); ++i) {
    read_block(file, seal, i, buffer.data());
    seal.sums.push_back(checksum(buffer.data(), block));
  }
  return seal;
}

RunningSums::RunningSums(std::uint64_t block) : block_(block), state_(XXH3_createState()) {}

RunningSums::~RunningSums() { XXH3_freeState(&of(state_)); }

void RunningSums::add(std::uint64_t offset, const void* bytes, std::size_t count) {
  const char* from = static_cast<const char*>(bytes);
  if (offset != next_) has_begin_ = false;
  while (count > 0) {
    const std::uint64_t inside = offset % block_;
    const std::size_t part = std::min<std::uint64_t>(count, block_ - inside);
    if (part == block_) {
      complete_.push_back({offset / block_, checksum(from, block_)});
    } else {
      if (inside == 0) {
        XXH3_64bits_reset(&of(state_));
        has_begin_ = true;
      }
      if (has_begin_) XXH3_64bits_update(&of(state_), from, part);
      if (has_begin_ && inside + part == block_)
        complete_.push_back({offset / block_, XXH3_64bits_digest(&of(state_))});
    }
    from += part;
    offset += part;
    count -= part;
  }
  next_ = offset;
}

}  // namespace mixbeam

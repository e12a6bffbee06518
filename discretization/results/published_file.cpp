#include "discretization/results/published_file.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <set>
#include <system_error>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

constexpr double kShareOfSyncs = 0.03;  // of the time of a run that waiting for the disk may take
// First guess of the cost of waiting: a rotating disk takes as long to answer, and writes 100 MB in a second.
constexpr double kFirstCost = 0.01, kCostOfByte = 1e-8;  // seconds

/// The blocks in which tables lie, ascending.
std::vector<std::uint64_t> blocks_of(const std::vector<ResultTable>& tables, const std::vector<std::uint64_t>& places,
                                     std::uint64_t block) {
  std::vector<std::uint64_t> blocks;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (tables[i].shape.rows == 0) continue;
    const std::uint64_t end = places[i] + tables[i].shape.bytes();
    for (std::uint64_t number = places[i] / block; number * block < end; ++number) blocks.push_back(number);
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

/// Copies blocks after a check of their sums; neighbours in one piece.
void copy_blocks(const fs::path& from, const fs::path& to, bool shared, const BlockSum* blocks, std::size_t count,
                 std::uint64_t block, std::uint64_t bytes) {
  if (count == 0) return;
  const DiskFile source(from, DiskAccess::read);
  DiskFile target(to, DiskAccess::write, shared);
  std::vector<std::byte> buffer(std::max<std::size_t>(TableWriter::kBufferBytes, block));
  const std::size_t most = buffer.size() / block;
  for (std::size_t i = 0, joined = 0; i < count; i += joined) {
    for (joined = 1; joined < std::min(most, count - i) && blocks[i + joined].block == blocks[i].block + joined;)
      ++joined;
    const std::uint64_t first = blocks[i].block * block;
    const std::size_t part = std::min(joined * block, bytes - first);
    source.read(first, buffer.data(), part);
    std::fill(buffer.begin() + static_cast<std::ptrdiff_t>(part),
              buffer.begin() + static_cast<std::ptrdiff_t>(joined * block), std::byte{0});
    for (std::size_t k = 0; k < joined; ++k)
      if (checksum(buffer.data() + k * block, block) != blocks[i + k].sum)
        throw DamageError(text_of_damage(first + k * block, first + (k + 1) * block));
    target.write(first, buffer.data(), part);
  }
  target.close();
}

/// Broadcasts a value of rank 0.
template <class Value>
void share(const Teuchos::Comm<int>& communicator, std::vector<Value>& values) {
  if (communicator.getSize() == 1) return;
  long long size = static_cast<long long>(values.size());
  Teuchos::broadcast(communicator, 0, &size);
  values.resize(static_cast<std::size_t>(size));
  Teuchos::broadcast(communicator, 0, static_cast<int>(values.size() * sizeof(Value)),
                     reinterpret_cast<char*>(values.data()));
}

/// Sums known to exactly one rank, from all ranks. `blocks`: those that may have such a sum, ascending.
std::vector<BlockSum> gathered(const Teuchos::Comm<int>& communicator, const std::vector<BlockSum>& own,
                               const std::vector<std::uint64_t>& blocks) {
  if (communicator.getSize() == 1) return own;
  std::vector<long long> mine(2 * blocks.size(), 0), all(mine.size(), 0);  // sum of each block; how many know it
  for (const BlockSum& known : own) {
    const auto place = std::lower_bound(blocks.begin(), blocks.end(), known.block) - blocks.begin();
    mine[2 * place] = static_cast<long long>(known.sum);
    mine[2 * place + 1] = 1;
  }
  Teuchos::reduceAll(communicator, Teuchos::REDUCE_SUM, static_cast<int>(mine.size()), mine.data(), all.data());
  std::vector<BlockSum> sums;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (all[2 * i + 1] == 1) sums.push_back({blocks[i], static_cast<std::uint64_t>(all[2 * i])});
  return sums;
}

}  // namespace

bool SyncBudget::affords(std::uint64_t bytes) const {
  const double spent = std::chrono::duration<double>(Clock::now() - since_).count();
  const double cost = cost_ ? *cost_ : kFirstCost + static_cast<double>(bytes) * kCostOfByte;
  return every_step_ || cost <= kShareOfSyncs * spent;
}

void SyncBudget::spend(const std::function<void()>& sync) {
  const auto start = Clock::now();
  sync();
  cost_ = std::chrono::duration<double>(Clock::now() - start).count();
}

PublishedFile::PublishedFile(const fs::path& path, const FileRanks& ranks, bool durable)
    : path_(path), new_name_(hidden(path, "new")), ranks_(ranks), budget_(durable), named_(file_number(path)) {
  copies_[0].path = hidden(path_, "a");
  copies_[1].path = hidden(path_, "b");
}

void PublishedFile::begin(std::uint64_t block, const Write& write) {
  seal_.block = block;
  DiskFile file(next().path, DiskAccess::create);
  GuardedFile content(file, seal_);
  write(content);
  file.reserve(seal_.bytes + seal_.bytes_behind());
  content.flush();
  write_seal(file, seal_);
  file.close();
  next().exists = true;
  next().bytes = seal_.bytes;
  written_ = seal_.bytes;
}

void PublishedFile::catch_up() {
  std::vector<BlockSum> missing;
  std::vector<std::uint64_t> sizes;
  ranks_.on_root([&] {
    missing = next().exists ? changed_ : seal_.all();
    written_ = missing.size() * seal_.block;
    DiskFile file(next().path, next().exists ? DiskAccess::write : DiskAccess::create);
    file.resize(next().bytes);  // cuts its old seal off
    file.reserve(seal_.bytes);
    file.resize(seal_.bytes);
    file.close();
    sizes = {seal_.block, seal_.bytes};
  });
  share(ranks_.communicator(), missing);
  share(ranks_.communicator(), sizes);
  ranks_.together([&] {
    const bool shared = ranks_.number().ranks > 1;
    for (const RowRun& run : even_share(missing.size(), ranks_.number().rank, ranks_.number().ranks).runs)
      copy_blocks(published().path, next().path, shared, missing.data() + run.first, run.count, sizes[0], sizes[1]);
  });
}

void PublishedFile::use_large_blocks() {
  const DiskFile file(next().path, DiskAccess::read);
  seal_ = seal_of(file, seal_.bytes, kLargeBlock);
}

void PublishedFile::change(const Write& write) {
  DiskFile file(next().path, DiskAccess::write);
  GuardedFile content(file, seal_);
  write(content);
  file.reserve(seal_.bytes + seal_.bytes_behind());
  content.flush();
  file.close();
  changed_.clear();
  for (const std::uint64_t number : content.changed()) changed_.push_back({number, 0});
}

void PublishedFile::write_tables(const std::vector<ResultTable>& tables, std::vector<std::uint64_t> places) {
  if (ranks_.is_root()) places.push_back(seal_.block);
  share(ranks_.communicator(), places);
  const std::uint64_t block = places.back();
  std::vector<BlockSum> sums;
  ranks_.together([&] {
    TableWriter file(next().path, ranks_.number().ranks > 1, block);
    for (std::size_t i = 0; i < tables.size(); ++i)
      if (tables[i].shape.rows > 0) tables[i].write(file, places[i]);
    file.close();
    sums = file.sums();
  });
  const std::vector<std::uint64_t> blocks = blocks_of(tables, places, block);
  sums = gathered(ranks_.communicator(), sums, blocks);
  ranks_.on_root([&] { seal_next(sums, blocks); });
}

// `blocks`: those in which tables lie; `sums`: of those that one rank has filled.
void PublishedFile::seal_next(const std::vector<BlockSum>& sums, const std::vector<std::uint64_t>& blocks) {
  DiskFile file(next().path, DiskAccess::write);
  std::set<std::uint64_t> unknown(blocks.begin(), blocks.end());
  for (const BlockSum& known : sums) {
    seal_.sums[known.block] = known.sum;
    unknown.erase(known.block);
  }
  std::vector<std::byte> buffer(seal_.block);
  for (const std::uint64_t number : unknown) {
    read_block(file, seal_, number, buffer.data());
    seal_.sums[number] = checksum(buffer.data(), buffer.size());
  }
  write_seal(file, seal_);
  file.close();
  std::set<std::uint64_t> changed(blocks.begin(), blocks.end());
  for (const BlockSum& of_frame : changed_) changed.insert(of_frame.block);
  changed_.clear();
  for (const std::uint64_t number : changed) changed_.push_back({number, seal_.sums[number]});
  written_ += changed_.size() * seal_.block;
  next().exists = true;
  next().bytes = seal_.bytes;
}

// Duplicates the copy if the file system has no hard links.
void PublishedFile::give_name() {
  if (is_synced_) DiskFile(next().path, DiskAccess::write).sync();
  std::error_code error;
  fs::remove(new_name_, error);
  fs::create_hard_link(next().path, new_name_, error);
  if (error) fs::copy_file(next().path, new_name_, error);
  if (!error) fs::rename(new_name_, path_, error);
  if (error) throw DiskError("cannot be renamed to its final name: " + error.message());
  if (is_synced_) sync_folder_of(path_);
}

void PublishedFile::publish() {
  ranks_.on_root([&] {
    const FileNumber there = file_number(path_);
    if (there.inode != 0 && !(there == named_))
      throw DiskError("another program has replaced it; that file is left as it is, and the run ends");
    is_synced_ = budget_.affords(written_);
    if (is_synced_)
      budget_.spend([&] { give_name(); });
    else
      give_name();
    named_ = file_number(path_);
    budget_.start_step();
  });
  next_ = 1 - next_;
}

void PublishedFile::remove_copies() const noexcept {
  std::error_code ignored;
  for (const auto& path : {copies_[0].path, copies_[1].path, new_name_}) fs::remove(path, ignored);
}

void PublishedFile::sync() {
  if (is_synced_ || !(file_number(path_) == named_)) return;
  DiskFile file(path_, DiskAccess::write);
  file.sync();
  file.close();
  sync_folder_of(path_);
  is_synced_ = true;
}

}  // namespace mixbeam

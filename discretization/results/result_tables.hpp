/// The large datasets of a result file: fields at samples, vertices and elements, with their XDMF description. Each
/// rank writes the rows that it holds. Layout: apps/docs/results.md.
#pragma once

#include "discretization/results/disk_file.hpp"
#include "discretization/results/rank_agreement.hpp"
#include "discretization/results/seal.hpp"
#include "discretization/state/member_samples.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

/// Rows of tables on their way into a file to which other ranks write other rows, and the sums of the blocks that they
/// fill.
class TableWriter {
 public:
  /// Bytes that are held in memory at a time: large enough for the speed of single large writes, small beside anything
  /// else that a rank holds.
  static constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

  /// `block`: bytes of a block of the file's seal. Throws DiskError, as the calls below.
  TableWriter(const std::filesystem::path& path, bool shared, std::uint64_t block)
      : file_(path, DiskAccess::write, shared), sums_(block), buffer_(new std::byte[kBufferBytes]) {}

  void write(std::uint64_t offset, const void* bytes, std::size_t count) {
    file_.write(offset, bytes, count);
    sums_.add(offset, bytes, count);
  }
  void close() { file_.close(); }
  const std::vector<BlockSum>& sums() const { return sums_.complete(); }
  /// Room for kBufferBytes that are about to be written.
  std::byte* buffer() { return buffer_.get(); }

 private:
  DiskFile file_;
  RunningSums sums_;
  std::unique_ptr<std::byte[]> buffer_;
};

enum class TableNumbers { doubles, integers };

/// A dataset, the same on every rank.
struct TableShape {
  std::string name;  ///< path in the file
  TableNumbers numbers = TableNumbers::doubles;
  std::size_t rows = 0, columns = 1;

  std::size_t bytes_of_row() const {
    return columns * (numbers == TableNumbers::doubles ? sizeof(double) : sizeof(int));
  }
  std::size_t bytes() const { return rows * bytes_of_row(); }
};

struct ResultTable {
  TableShape shape;
  /// Writes the rows of this rank; `offset`: where the first row of the table lies in the file. Throws DiskError.
  std::function<void(TableWriter& file, std::uint64_t offset)> write;
};

/// "000001" of step 1.
std::string step_group_name(int step);

/// Tables that describe the members, from their first record. They refer to `members`, which must outlive them.
std::vector<ResultTable> tables_of_members(const SampledMembers& members);

/// Stresses at each sample that a step may have.
inline constexpr std::array<const char*, 4> kStressNames = {"largest_normal_stress", "largest_shear_stress",
                                                            "von_mises_stress", "utilisation"};

/// Names the stresses that a step has: utilisation where some material has a strength.
std::vector<std::string> stresses_of_step(const StepRecord& record);

/// Tables of a step; they refer to `record`, which must outlive them.
std::vector<ResultTable> tables_of_step(const StepRecord& record, RankNumber rank);

/// Numbers of one step for the description in XDMF.
struct XdmfStep {
  int step = 0;  ///< shown as time, because the load factor need not grow
  double load_factor = 0.0;
  std::vector<std::string> stresses{};  ///< names, as stresses_of_step
};

/// Writes XDMF text for `steps` of the HDF5 file named `data_file` (as seen from the folder of the XDMF file). Every
/// member is one polyline through its deformed samples; `connectivity` is the length of /polyline/connectivity.
void write_xdmf_text(const TextSink& sink, const std::string& data_file, const std::vector<XdmfStep>& steps,
                     std::size_t members, std::size_t samples, std::size_t connectivity);

}  // namespace mixbeam

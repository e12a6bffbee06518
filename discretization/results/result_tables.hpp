/// The large datasets of a result file: fields at samples, vertices and elements, of which each rank writes the rows
/// that it holds. Layout in result_file.hpp.
#pragma once

#include "discretization/results/slab_file.hpp"
#include "discretization/state/member_samples.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mixbeam {

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

/// Which of how many ranks writes.
struct RankNumber {
  int rank = 0, ranks = 1;
};

struct ResultTable {
  TableShape shape;
  /// Writes the rows of this rank; `offset`: where the first row of the table lies in the file. Throws SlabError.
  std::function<void(SlabFile& file, std::uint64_t offset)> write;
};

/// "000001" of step 1.
std::string step_group_name(int step);

/// What describes the members, from their first record. The tables refer to `members`, which must outlive them.
std::vector<ResultTable> tables_of_members(const std::vector<MemberSamples>& members, RankNumber rank);

/// Those of a step; they refer to `record`, which must outlive them.
std::vector<ResultTable> tables_of_step(const StepRecord& record, RankNumber rank);

/// The bytes of a table that `source` holds at `offset`, shared out evenly.
ResultTable copied_table(const TableShape& shape, std::shared_ptr<SlabFile> source, std::uint64_t offset,
                         RankNumber rank);

}  // namespace mixbeam

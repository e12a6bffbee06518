#include "nonlinear/stability/independent_unknowns.hpp"

#include "discretization/text/errors.hpp"
#include "nonlinear/linear/linear_solver.hpp"
#include "nonlinear/stability/thresholds.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <string>

namespace mixbeam {

std::vector<double> vertex_lengths(const Structure& structure) {
  std::vector<double> length(structure.owned_vertices, 0.0);
  for (const int local : structure.elements_in_order) {
    const ElementBlock& block = structure.block_of(local);
    const int e = local - block.first_element;
    for (int end = 0; end < 2; ++end)
      if (const int vertex = block.vertices(e, end); vertex < structure.owned_vertices)
        length[vertex] += 0.5 * block.reference(e, block.reference_layout.length());
  }
  return length;
}

IndependentUnknowns::IndependentUnknowns(const Model& model)
    : whole_(std::make_unique<VertexMatrix>(whole_matrix(model))),
      root_(whole_->matrix()),
      map_(model.map()),
      rows_(model.map()) {
  own_.resize(model.structure().owned_vertices);
  std::iota(own_.begin(), own_.end(), 0);
  set_up(model);
}

IndependentUnknowns::IndependentUnknowns(const Model& model, const VertexMatrix& remaining)
    : root_(remaining.matrix()), map_(model.map()), rows_(remaining.matrix()->getRowMap()) {
  const KernelView<int*> vertices = remaining.vertices();
  own_.assign(vertices.data(), vertices.data() + vertices.extent(0));
  set_up(model);
}

void IndependentUnknowns::set_up(const Model& model) {
  vertices_ = static_cast<int>(rows_->getGlobalNumElements()) / kVertexDofs;
  number(model);
  measure(model);
  if (is_root()) build_structure();
}

/// Gathers the rows of the vertices that are numbered here on rank 0.
std::vector<double> IndependentUnknowns::gather_rows(const DofVector& all) const {
  DofVector chosen(rows_);
  const KernelView<double*> to = MixedVector::view_of(chosen);
  const KernelView<const double*> from = MixedVector::view_of(all);
  for (size_t i = 0; i < own_.size(); ++i)
    for (int c = 0; c < kVertexDofs; ++c) to(kVertexDofs * i + c) = from(vertex_row(own_[i], c));
  std::vector<double> result(is_root() ? static_cast<size_t>(kVertexDofs) * vertices_ : 0);
  root_.gather(chosen, result.data());
  return result;
}

/// Numbers the free rows as unknowns, in the order of vertices.
void IndependentUnknowns::number(const Model& model) {
  const Structure& structure = model.structure();
  DofVector numbers(map_), fixed(map_);
  const KernelView<double*> names = MixedVector::view_of(numbers), held = MixedVector::view_of(fixed);
  for (size_t i = 0; i < held.extent(0); ++i) {
    held(i) = model.fixed_rows()(i);
    names(i) = structure.local_vertex_to_global[i / kVertexDofs];
  }
  const std::vector<double> name = gather_rows(numbers), is_fixed = gather_rows(fixed);
  std::vector<int> place(is_root() ? model.mesh().vertices() : 0, -1);
  for (int v = 0; is_root() && v < vertices_; ++v) {
    vertex_of_mesh_.push_back(static_cast<int>(name[static_cast<size_t>(kVertexDofs) * v]));
    place[vertex_of_mesh_.back()] = v;
  }
  master_.assign(is_root() ? vertices_ : 0, -1);
  colour_.assign(model.mesh().vertices(), 0);
  std::vector<int> slaves(model.mesh().vertices(), 0);
  for (const MeshJoint& joint : model.mesh().joints) {
    if (is_root()) master_[place[joint.slave]] = place[joint.master];
    colour_[joint.slave] = ++slaves[joint.master];
    colours_ = std::max(colours_, 1 + colour_[joint.slave]);
  }
  unknown_.assign(is_fixed.size(), -1);
  for (size_t i = 0; i < is_fixed.size(); ++i)
    if (is_fixed[i] == 0.0) unknown_[i] = count_++;
  root_.share(&count_, 1, MPI_INT);
}

void IndependentUnknowns::measure(const Model& model) {
  const Structure& structure = model.structure();
  const std::vector<double> of_own = vertex_lengths(structure);
  DofVector rows(map_);
  const KernelView<double*> lengths = MixedVector::view_of(rows);
  for (size_t i = 0; i < lengths.extent(0); ++i) lengths(i) = of_own[i / kVertexDofs];
  const std::vector<double> length = gather_rows(rows);  // on rank 0, like measure_
  const double L = structure.length, bending = structure.bending_reference / L;
  measure_.resize(unknown_.size());
  for (size_t i = 0; i < measure_.size(); ++i)
    measure_[i] = (i % kVertexDofs < 3 ? L : 1.0) / std::sqrt(bending * length[i] / L);
}

/// Builds the structure of the reduced matrix; columns of slaves become those of their free motion and their master.
void IndependentUnknowns::build_structure() {
  const auto graph = root_.matrix()->getLocalMatrixHost().graph;
  neighbours_.resize(vertices_);
  reduced_.row_start = {0};
  for (int v = 0; v < vertices_; ++v) {
    std::set<int> columns;
    const size_t row = static_cast<size_t>(kVertexDofs) * v;
    for (size_t k = graph.row_map(row); k < graph.row_map(row + 1); k += kVertexDofs) {
      const int w = graph.entries(k) / kVertexDofs;
      columns.insert(w);
      if (master_[w] >= 0) columns.insert(master_[w]);
    }
    neighbours_[v].assign(columns.begin(), columns.end());
    for (int r = 0; r < kVertexDofs; ++r) {
      if (unknown(v, r) < 0) continue;
      for (int w : neighbours_[v])
        for (int c = 0; c < kVertexDofs; ++c)
          if (unknown(w, c) >= 0) reduced_.column.push_back(unknown(w, c));
      reduced_.row_start.push_back(static_cast<int>(reduced_.column.size()));
    }
  }
  reduced_.value.resize(reduced_.column.size());
}

/// Projects unit forces on all vertices of one colour at once: a row has contributions from its own vertex and from the
/// slaves of it, which all have different colours.
void IndependentUnknowns::probe(const Tangent& tangent) {
  const Structure& structure = tangent.model().structure();
  unit_force_.resize(static_cast<size_t>(kVertexDofs) * colours_);
  DofVector rows(map_);
  for (int k = 0; k < kVertexDofs * colours_; ++k) {
    const KernelView<double*> mine = MixedVector::view_of(rows);
    for (int v = 0; v < structure.owned_vertices; ++v)
      for (int c = 0; c < kVertexDofs; ++c)
        mine(kVertexDofs * v + c) = kVertexDofs * colour_[structure.local_vertex_to_global[v]] + c == k ? 1.0 : 0.0;
    tangent.project_on_free_motions(mine);
    unit_force_[k] = gather_rows(rows);
  }
}

/// Displacement or rotation `component` of a vertex per unit of a free component of itself or of its master.
double IndependentUnknowns::motion_of(int vertex, int component, int by_vertex, int by_component) const {
  return unit_force_[kVertexDofs * colour_[vertex_of_mesh_[vertex]] + component]
                    [kVertexDofs * by_vertex + by_component];
}

/// Computes a row of A times Z, in the units of the unknowns.
void IndependentUnknowns::reduce_row(const DofMatrix::local_matrix_host_type& full, size_t row,
                                     const std::vector<int>& slot, double* out) const {
  for (size_t k = full.graph.row_map(row); k < full.graph.row_map(row + 1); ++k) {
    const int moved = full.graph.entries(k);
    const double a = full.values(k) * measure_[row];
    for (size_t s = share_start_[moved]; s < share_start_[moved + 1]; ++s)
      out[slot[share_[s].unknown]] += a * share_[s].motion;
  }
}

/// Lists the entries of Z by rows, nearly all of which have one entry.
void IndependentUnknowns::list_shares() {
  share_.clear();
  share_start_ = {0};
  for (int v = 0; v < vertices_; ++v)
    for (int c = 0; c < kVertexDofs; ++c) {
      for (int by : {v, master_[v]})
        for (int i = 0; by >= 0 && i < kVertexDofs; ++i)
          if (const double motion = unknown(by, i) < 0 ? 0.0 : motion_of(v, c, by, i); motion != 0.0)
            share_.push_back({unknown(by, i), motion * measure_[static_cast<size_t>(kVertexDofs) * by + i]});
      share_start_.push_back(share_.size());
    }
}

const SparseMatrix& IndependentUnknowns::reduce(const Tangent& tangent) {
  return reduce(tangent, [&](const VertexMatrix& matrix) { tangent.gather(matrix); });
}

const SparseMatrix& IndependentUnknowns::reduce(const Tangent& tangent,
                                                const std::function<void(const VertexMatrix&)>& gather) {
  probe(tangent);
  if (whole_ != nullptr) gather(*whole_);
  root_.gather_values();
  if (!is_root()) return reduced_;
  list_shares();
  const auto local = root_.matrix()->getLocalMatrixHost();
  std::fill(reduced_.value.begin(), reduced_.value.end(), 0.0);
  std::vector<int> slot(unknown_.size(), -1);  // (unknown): its position in the rows of the present vertex
  for (int v = 0; v < vertices_; ++v) {
    int width = 0;
    for (int w : neighbours_[v])
      for (int c = 0; c < kVertexDofs; ++c)
        if (unknown(w, c) >= 0) slot[unknown(w, c)] = width++;
    for (int r = 0; r < kVertexDofs; ++r)
      if (unknown(v, r) >= 0)
        reduce_row(local, kVertexDofs * v + r, slot, &reduced_.value[reduced_.row_start[unknown(v, r)]]);
  }
  return reduced_;
}

std::vector<double> IndependentUnknowns::reduced_rows(const DofVector& projected) const {
  return measured(gather_rows(projected));
}

std::vector<double> IndependentUnknowns::reduced_remaining_rows(const DofVector& rows) const {
  std::vector<double> gathered(is_root() ? static_cast<size_t>(kVertexDofs) * vertices_ : 0);
  root_.gather(rows, gathered.data());
  return measured(gathered);
}

/// Selects the free rows, in the order and units of the unknowns.
std::vector<double> IndependentUnknowns::measured(const std::vector<double>& rows) const {
  std::vector<double> reduced(is_root() ? count_ : 0);
  for (size_t i = 0; is_root() && i < unknown_.size(); ++i)
    if (unknown_[i] >= 0) reduced[unknown_[i]] = rows[i] * measure_[i];
  return reduced;
}

void IndependentUnknowns::expand(const double* y, DofVector& motion) const {
  std::vector<double> all(unknown_.size(), 0.0);
  for (size_t row = 0; is_root() && row < all.size(); ++row)
    for (size_t s = share_start_[row]; s < share_start_[row + 1]; ++s)
      all[row] += share_[s].motion * y[share_[s].unknown];
  root_.scatter(all.data(), motion);
}

MixedVector complete_motion(const Tangent& tangent, const IndependentUnknowns& unknowns, const std::vector<double>& y) {
  MixedVector by_residual = tangent.model().create_vector(), motion = by_residual.clone(false);
  tangent.recover(by_residual);
  unknowns.expand(y.data(), motion.vertex_dofs());
  tangent.recover(motion);
  motion.update(-1.0, by_residual, 1.0);
  return motion;
}

MixedVector combination(const std::vector<MixedVector>& vectors, const double* weights) {
  MixedVector sum = vectors.front().clone(false);
  sum.fill(0.0);
  for (size_t i = 0; i < vectors.size(); ++i) sum.update(weights[i], vectors[i], 1.0);
  return sum;
}

double normalize_mode(const Model& model, MixedVector& mode) {
  const KernelView<double*> rows = mode.vertex();
  const double length = model.structure().length;
  const auto size = [&](size_t i) { return rows(i) / (i % kVertexDofs < 3 ? length : 1.0); };
  double largest = 0.0;
  for (size_t i = 0; i < rows.extent(0); ++i) largest = std::max(largest, std::abs(size(i)));
  const Teuchos::Comm<int>& comm = *model.map()->getComm();
  largest = maximum_over_ranks(comm, largest);
  // Encodes rank and sign of the first of the largest components in one number, which is largest on the lowest rank.
  double first = -2.0 * comm.getSize();
  for (size_t i = 0; i < rows.extent(0); ++i)
    if (std::abs(size(i)) >= stability_limit.almost_largest * largest) {
      first = -2.0 * comm.getRank() - (size(i) < 0.0 ? 1.0 : 0.0);
      break;
    }
  first = maximum_over_ranks(comm, first);
  const bool turned = std::fmod(-first, 2.0) == 1.0;
  const double factor = largest > 0.0 ? (turned ? -1.0 : 1.0) / largest : 1.0;
  if (largest > 0.0) mode.scale(factor);
  return factor;
}

void on_root(const RootCopy& root, const std::function<void()>& action) {
  std::string problem;
  if (root.is_root()) {
    try {
      action();
    } catch (const std::exception& error) {
      if (is_out_of_memory(error)) throw;  // a smaller step would need as much
      problem = error.what();
    }
  }
  int failed = problem.empty() ? 0 : 1;
  root.share(&failed, 1, MPI_INT);
  if (failed != 0) throw LinearSolverError("stability: " + (problem.empty() ? "see rank 0" : problem));
}

double number_of_root(const RootCopy& root, const std::function<double()>& number) {
  double found = 0.0;
  on_root(root, [&] { found = number(); });
  root.share(&found, 1, MPI_DOUBLE);
  return found;
}

}  // namespace mixbeam

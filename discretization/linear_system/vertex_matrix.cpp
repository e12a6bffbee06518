#include "discretization/linear_system/vertex_matrix.hpp"

#include <algorithm>
#include <utility>

namespace mixbeam {

namespace {

using Range = Kokkos::RangePolicy<ExecutionSpace>;

/// Link at a vertex.
struct Touch {
  int link, order;
  int end;    ///< end of the link at the vertex
  int other;  ///< place of the vertex at its other end
};

std::vector<std::vector<Touch>> links_at_vertices(const std::vector<RemainingLink>& links, int rows,
                                                  const KernelView<int*>& place) {
  std::vector<std::vector<Touch>> touching(rows);
  for (const RemainingLink& link : links)
    for (int end = 0; end < 2; ++end) {
      const int here = place(link.vertex[end]);
      if (here >= 0 && here < rows)
        touching[here].push_back({link.link, link.first_element, end, place(link.vertex[1 - end])});
    }
  for (std::vector<Touch>& touches : touching)
    std::sort(touches.begin(), touches.end(), [](const Touch& a, const Touch& b) {
      return std::make_pair(a.order, a.end) < std::make_pair(b.order, b.end);
    });
  return touching;
}

/// Columns of a block row: the vertex itself and its neighbours, ascending and unique.
std::vector<int> row_columns(int vertex, const std::vector<Touch>& touches) {
  std::vector<int> columns = {vertex};
  for (const Touch& touch : touches) columns.push_back(touch.other);
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

/// Rows of a master get the columns of its slaves, and rows of a slave that of the master.
void couple_joints(const std::vector<VertexJoint>& joints, const KernelView<int*>& place,
                   std::vector<std::vector<int>>& columns) {
  for (const VertexJoint& joint : joints) {
    std::vector<int>& master = columns[place(joint.master)];
    std::vector<int>& slave = columns[place(joint.slave)];
    master.insert(master.end(), slave.begin(), slave.end());
    slave.push_back(place(joint.master));
    for (std::vector<int>* both : {&master, &slave}) {
      std::sort(both->begin(), both->end());
      both->erase(std::unique(both->begin(), both->end()), both->end());
    }
  }
}

}  // namespace

VertexMatrix::VertexMatrix(const Structure& structure, const VertexMaps& maps,
                           const std::vector<unsigned char>& present, std::vector<RemainingLink> links,
                           const std::vector<VertexJoint>& joints)
    : owned_(structure.owned_vertices) {
  for (RemainingLink& link : links) link.first_element = structure.local_element_to_mesh[link.first_element];
  build_maps(maps, present);
  build_graph(links, joints);
}

/// Rows are numbered through the ranks; ghosts get their numbers from their owners.
void VertexMatrix::build_maps(const VertexMaps& maps, const std::vector<unsigned char>& present) {
  std::vector<int> vertices;
  place_ = KernelView<int*>("mixbeam::place", present.size());
  int places = 0;
  for (size_t v = 0; v < present.size(); ++v) {
    place_(v) = present[v] != 0 ? places++ : -1;
    if (present[v] != 0 && static_cast<int>(v) < owned_) vertices.push_back(static_cast<int>(v));
  }
  vertices_ = KernelView<int*>("mixbeam::row_vertices", vertices.size());
  std::copy(vertices.begin(), vertices.end(), vertices_.data());
  const auto unknown = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  const auto comm = maps.rows->getComm();
  row_map_ = Teuchos::rcp(new DofMap(unknown, kVertexDofs * vertices.size(), 0, comm));
  column_map_ = row_map_;
  if (maps.import.is_null()) return;
  DofVector mine(maps.rows), all(maps.columns);
  const KernelView<double*> numbers = MixedVector::view_of(mine);
  for (size_t row = 0; row < vertices.size(); ++row)
    numbers(vertex_row(vertices[row], 0)) = static_cast<double>(row_map_->getGlobalElement(kVertexDofs * row));
  all.doImport(mine, *maps.import, Tpetra::REPLACE);
  const KernelView<double*> known = MixedVector::view_of(all);
  std::vector<GlobalOrdinal> dofs;
  for (size_t v = 0; v < present.size(); ++v)
    for (int c = 0; present[v] != 0 && c < kVertexDofs; ++c)
      dofs.push_back(static_cast<GlobalOrdinal>(known(vertex_row(static_cast<int>(v), 0))) + c);
  column_map_ = Teuchos::rcp(new DofMap(unknown, Teuchos::arrayViewFromVector(dofs), 0, comm));
  import_ = Teuchos::rcp(new DofImport(row_map_, column_map_));
}

void VertexMatrix::build_graph(const std::vector<RemainingLink>& links, const std::vector<VertexJoint>& joints) {
  const int n = static_cast<int>(vertices_.extent(0));
  const std::vector<std::vector<Touch>> touching = links_at_vertices(links, n, place_);
  std::vector<std::vector<int>> columns(n);
  start_ = KernelView<int*>("mixbeam::adjacency_start", n + 1);
  for (int v = 0; v < n; ++v) {
    columns[v] = row_columns(v, touching[v]);
    start_(v + 1) = start_(v) + static_cast<int>(touching[v].size());
  }
  couple_joints(joints, place_, columns);
  size_t entries = 0;
  for (int v = 0; v < n; ++v) entries += kVertexDofs * kVertexDofs * columns[v].size();
  adjacency_ = KernelView<int* [4]>("mixbeam::adjacency", start_(n));
  for (int v = 0; v < n; ++v) {
    const auto slot = [&](int vertex) {
      return static_cast<int>(std::lower_bound(columns[v].begin(), columns[v].end(), vertex) - columns[v].begin());
    };
    int a = start_(v);
    for (const Touch& touch : touching[v]) {
      const int row[4] = {touch.link, touch.end, slot(v), slot(touch.other)};
      std::copy_n(row, 4, &adjacency_(a++, 0));
    }
  }
  build_matrix(columns, entries);
}

/// Allocates a zero matrix with the given block columns of each vertex.
void VertexMatrix::build_matrix(const std::vector<std::vector<int>>& columns, size_t entries) {
  using LocalGraph = DofMatrix::local_graph_host_type;
  LocalGraph::row_map_type::non_const_type row_start("mixbeam::row_start", kVertexDofs * columns.size() + 1);
  LocalGraph::entries_type::non_const_type column("mixbeam::column", entries);
  DofMatrix::local_matrix_host_type::values_type::non_const_type values("mixbeam::matrix_values", entries);
  for (size_t row = 0; row + 1 < row_start.extent(0); ++row) {
    const std::vector<int>& neighbours = columns[row / kVertexDofs];
    size_t entry = row_start(row);
    for (int vertex : neighbours)
      for (int c = 0; c < kVertexDofs; ++c) column(entry++) = kVertexDofs * vertex + c;
    row_start(row + 1) = entry;
  }
  matrix_ = Teuchos::rcp(new DofMatrix(row_map_, column_map_, row_start, column, values));
  matrix_->expertStaticFillComplete(row_map_, row_map_, import_);
}

void VertexMatrix::gather(const LinkMatrices<kSpatialDofs>& links) const {
  const auto local = matrix_->getLocalMatrixHost();
  const auto values = local.values;
  const auto row_start = local.graph.row_map;
  const auto start = start_;
  const auto adjacency = adjacency_;
  Kokkos::parallel_for(
      "mixbeam::gather::matrix", Range(0, vertices_.extent(0)), KOKKOS_LAMBDA(int v) {
        const size_t first = row_start(kVertexDofs * v), width = row_start(kVertexDofs * v + 1) - first;
        double* rows = &values(first);
        for (size_t c = 0; c < kVertexDofs * width; ++c) rows[c] = 0.0;
        double room[LinkMatrices<kSpatialDofs>::kFull];
        for (int a = start(v); a < start(v + 1); ++a) {
          const int end = adjacency(a, 1);
          const double* link = links.full(adjacency(a, 0), room) + 12 * kVertexDofs * end;
          for (int r = 0; r < kVertexDofs; ++r, link += 12) {
            double* here = rows + width * r + kVertexDofs * adjacency(a, 2);
            double* there = rows + width * r + kVertexDofs * adjacency(a, 3);
            for (int c = 0; c < kVertexDofs; ++c) here[c] += link[kVertexDofs * end + c];
            for (int c = 0; c < kVertexDofs; ++c) there[c] += link[kVertexDofs * (1 - end) + c];
          }
        }
      });
}

void VertexMatrix::sum_at_ends(const KernelView<double* [12]>& arrived, int first_run,
                               const KernelView<double*>& rows) const {
  const auto start = start_;
  const auto adjacency = adjacency_;
  const auto vertices = vertices_;
  Kokkos::parallel_for(
      "mixbeam::gather::arrived", Range(0, vertices.extent(0)), KOKKOS_LAMBDA(int v) {
        double sum[kVertexDofs] = {};
        for (int a = start(v); a < start(v + 1); ++a) {
          const int run = adjacency(a, 0) - first_run;
          for (int c = 0; run >= 0 && c < kVertexDofs; ++c) sum[c] += arrived(run, kVertexDofs * adjacency(a, 1) + c);
        }
        for (int c = 0; c < kVertexDofs; ++c) rows(vertex_row(vertices(v), c)) = sum[c];
      });
}

void VertexMatrix::run_forces(const LinkMatrices<kSpatialDofs>& links, const KernelView<double* [12]>& arrived,
                              int first_run, const KernelView<const double*>& x,
                              const KernelView<double*>& rows) const {
  const auto start = start_;
  const auto adjacency = adjacency_;
  const auto vertices = vertices_;
  const auto graph = matrix_->getLocalMatrixHost().graph;
  const auto row_start = graph.row_map;
  const auto columns = graph.entries;
  Kokkos::parallel_for(
      "mixbeam::gather::run_forces", Range(0, vertices.extent(0)), KOKKOS_LAMBDA(int v) {
        double sum[kVertexDofs] = {};
        for (int a = start(v); a < start(v + 1); ++a) {
          const int end = adjacency(a, 1), run = adjacency(a, 0) - first_run;
          if (run < 0) continue;
          const double* matrix = &links.runs(run, 12 * kVertexDofs * end);
          const int other = columns(row_start(kVertexDofs * v) + kVertexDofs * adjacency(a, 3)) / kVertexDofs;
          const double* here = &x(vertex_row(vertices(v), 0));
          const double* there = &x(vertex_row(vertices(other), 0));
          for (int r = 0; r < kVertexDofs; ++r) {
            const double* row = matrix + 12 * r;
            for (int c = 0; c < kVertexDofs; ++c)
              sum[r] += row[kVertexDofs * end + c] * here[c] + row[kVertexDofs * (1 - end) + c] * there[c];
            sum[r] -= arrived(run, kVertexDofs * end + r);
          }
        }
        for (int c = 0; c < kVertexDofs; ++c) rows(vertex_row(vertices(v), c)) = sum[c];
      });
}

}  // namespace mixbeam

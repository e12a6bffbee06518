/// Memory reused by the evaluations of a model, only for residual.cpp, cap.cpp and tangent.cpp: fresh pages of the
/// system cost more than the computations in them.
#pragma once

#include "discretization/assembly/cap.hpp"

namespace mixbeam {

/// Data of the elements that a tangent keeps.
struct TangentArrays {
  ElementEquations elements;  ///< condensed tangents and responses; rows are those of the workspace
  PlanarTangents planar;
  std::vector<PlanarBlock> planar_blocks;
  Teuchos::RCP<DofVector> condensed_rows;
  KernelView<int*> interior_negative;      ///< (element), allocated on first use
  std::vector<VibratingBlock> rotating{};  ///< rotating frame: condensed elements, theory (75); else empty
  KernelView<double*> rotating_rows{};     ///< interior right-hand side condensed last, in the form of take_residual()
};

/// Line fields summed last. An array that has been handed out is not written to again.
struct LastLineFields {
  ViewPool<KernelView<double* [3]>> pool;
  std::vector<double> factors;
  KernelView<double* [3]> values;
};

struct Workspace {
  ElementEquations rows;  ///< of the elements: gathered right after their evaluation
  LastLineFields line_fields;
  Teuchos::RCP<DofVector> ghosted_increment;
  ViewPool<KernelView<SectionConstants*>> sections;
  ViewPool<KernelView<double*>> end_angles;
  std::vector<std::shared_ptr<TangentArrays>> tangents;  ///< free if not in use elsewhere
};

/// Sums the rows of the elements at the vertices.
void gather_rows(const Model& model, const KernelView<double*>& rows);
/// Same in a plane: neighbours in a chain exchange one force, which acts on the end of one element and, with the
/// opposite sign, on the start of the next. `loads`: ElementEquations::planar_loads, empty: none.
void gather_planar_rows(const Model& model, const KernelView<double* [2]>& loads, const KernelView<double*>& rows);

}  // namespace mixbeam

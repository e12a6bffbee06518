/// Memory behind the evaluations of a model, for residual.cpp, cap.cpp and tangent.cpp alone: fresh pages of the system
/// cost more than the computations in them.
#pragma once

#include "discretization/assembly/cap.hpp"

namespace mixbeam {

/// Numbers of the elements that a tangent keeps.
struct TangentArrays {
  ElementEquations elements;  ///< condensed tangents and responses; rows are those of the workspace
  PlanarTangents planar;
  std::vector<PlanarBlock> planar_blocks;
  Teuchos::RCP<DofVector> condensed_rows;
  KernelView<int*> interior_negative;      ///< (element), once it was asked for
  std::vector<VibratingBlock> rotating{};  ///< in a frame: how each element is condensed, theory (75); else empty
  KernelView<double*> rotating_rows{};  ///< interior right-hand side that was condensed last, as take_residual() has it
};

/// Line fields that were added up last. An array that has been handed out is never written to again.
struct LastLineFields {
  ViewPool<KernelView<double* [3]>> pool;
  std::vector<double> factors;
  KernelView<double* [3]> values;
};

struct Workspace {
  ElementEquations rows;  ///< of the elements: gathered as soon as they have been evaluated
  LastLineFields line_fields;
  Teuchos::RCP<DofVector> ghosted_increment;
  ViewPool<KernelView<SectionConstants*>> sections;
  ViewPool<KernelView<double*>> end_angles;
  std::vector<std::shared_ptr<TangentArrays>> tangents;  ///< free where they are not in use elsewhere
};

/// Rows of the elements, summed at the vertices.
void gather_rows(const Model& model, const KernelView<double*>& rows);
/// Gathers the rows of a plane: two elements of a chain hold each other by the force that acts on the end of the one
/// and, with the opposite sign, on the start of the other. `loads`: ElementEquations::planar_loads, empty: none.
void gather_planar_rows(const Model& model, const KernelView<double* [2]>& loads, const KernelView<double*>& rows);

}  // namespace mixbeam

/// Tpetra types of the project.
#pragma once

#include "discretization/mesh/communicator.hpp"

#include <Tpetra_CrsGraph.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

namespace mixbeam {

using DofMap = Tpetra::Map<>;
using LocalOrdinal = DofMap::local_ordinal_type;
using GlobalOrdinal = DofMap::global_ordinal_type;
using TpetraNode = DofMap::node_type;
using DofGraph = Tpetra::CrsGraph<LocalOrdinal, GlobalOrdinal, TpetraNode>;
using DofMatrix = Tpetra::CrsMatrix<double, LocalOrdinal, GlobalOrdinal, TpetraNode>;
using DofVector = Tpetra::Vector<double, LocalOrdinal, GlobalOrdinal, TpetraNode>;
using DofImport = Tpetra::Import<LocalOrdinal, GlobalOrdinal, TpetraNode>;
// sizeof instantiates the classes here, and a precompiled header keeps them
static_assert(sizeof(DofMap) * sizeof(DofGraph) * sizeof(DofMatrix) * sizeof(DofVector) * sizeof(DofImport) > 0);

}  // namespace mixbeam

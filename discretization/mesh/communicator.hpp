/// The ranks that work on a structure together.
#pragma once

#include <Teuchos_Comm.hpp>
#include <Teuchos_RCP.hpp>

namespace mixbeam {

using Communicator = Teuchos::RCP<const Teuchos::Comm<int>>;

}  // namespace mixbeam

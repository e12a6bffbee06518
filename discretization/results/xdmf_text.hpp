/// The XDMF 3 description of a result file: what ParaView reads to show its steps as a time series of curves.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mixbeam {

/// What the description needs to know about one step.
struct XdmfStep {
  std::string group;  ///< of the step in the HDF5 file, "/steps/000001"
  int step = 0;       ///< shown as time, because the load factor need not grow
  double load_factor = 0.0;
};

/// XDMF text for `steps` of the HDF5 file named `data_file` (as seen from the folder of the XDMF file). Every member is
/// one polyline through its deformed samples; `connectivity` is the length of /polyline/connectivity.
std::string xdmf_text(const std::string& data_file, const std::vector<XdmfStep>& steps, std::size_t members,
                      std::size_t samples, std::size_t connectivity);

}  // namespace mixbeam

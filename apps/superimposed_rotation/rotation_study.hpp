/// The study of the superimposed rotation: what changes in a bent rod while its clamp turns. Nothing should.
#pragma once

#include "apps/common/run/application.hpp"

namespace mixbeam {

/// Quantity of the list "Expected": energy of the moment strains at the end of the run.
inline constexpr const char* kMomentEnergy = "moment energy";

/// Declaration of the list "Study".
ListSpec rotation_study_spec();

/// The scene as it stands: prints and checks the deviations at every increment, writes deviation.csv and single.h5.
void run_rotation(Application& app);

/// That, and the other element orders.
void run_rotation_study(Application& app);

}  // namespace mixbeam

/// Closed forms of the elastica: an inextensible, shear rigid cantilever of length 1 and EI = 1 under a dead force at
/// its tip.
#pragma once

namespace mixbeam {

struct ElasticaTip {
  double back = 0.0;    ///< against the direction of the undeformed axis
  double across = 0.0;  ///< to the side of the force
  double angle = 0.0;   ///< that the tip turns, in radians
};

/// Under a force across, any load = F L^2 / EI > 0. Relative error of `across` and `angle` a few roundings, of `back`
/// the same where load > 1, else absolute. (Bisshopp and Drucker, Quart. Appl. Math. 3, 1945)
ElasticaTip elastica_tip(double load);

/// Under a thrust P L^2 / EI > 0 against its axis with the fraction `eccentricity` > 0 of it across: the stable
/// equilibrium, which bends towards the force across; `angle` up to pi. Relative error a few roundings over that of the
/// eccentricity.
ElasticaTip thrust_tip(double thrust, double eccentricity);

}  // namespace mixbeam

/// Closed form of the elastica: an inextensible, shear rigid cantilever under a dead force across its tip.
#pragma once

namespace mixbeam {

/// Tip of the cantilever of length 1.
struct ElasticaTip {
  double back = 0.0;    ///< against the direction of the undeformed axis
  double across = 0.0;  ///< in the direction of the force
  double angle = 0.0;   ///< that the tip turns, in radians; below pi/2
};

/// `load`: F L^2 / EI > 0, any magnitude. Relative error of `across` and `angle` a few roundings, of `back` the same
/// where load > 1, else absolute. From theta'' = -load cos(theta), theta(0) = theta'(1) = 0, hence
/// theta' = sqrt(2 load (sin(angle) - sin(theta))): elliptic integrals (Bisshopp and Drucker, Quart. Appl. Math. 3,
/// 1945), here in a form without cancellation.
ElasticaTip elastica_tip(double load);

/// Tip of the same cantilever under a dead thrust against its axis with the fraction `eccentricity` > 0 of it across:
/// the stable equilibrium, which bends towards the force across; `angle` up to pi. `thrust`: P L^2 / EI > 0. With phi =
/// theta + atan(eccentricity) the curve is a pendulum's, phi'' = -R sin(phi), phi'(1) = 0: elliptic integrals between
/// the angle of the load and that of the tip. Relative error a few roundings over that of the eccentricity.
ElasticaTip thrust_tip(double thrust, double eccentricity);

}  // namespace mixbeam

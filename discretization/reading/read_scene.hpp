/// The scene as XML parameters: their declaration, and reading them into a Scene.
#pragma once

#include "discretization/parameters/source.hpp"
#include "discretization/parameters/spec.hpp"
#include "discretization/scene/scene.hpp"

#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace mixbeam {

inline constexpr int kMostElements =
    10'000'000;  ///< of one member and of the whole scene; keeps slips from eating memory

/// Declaration of the list "Scene".
ListSpec scene_spec();

/// Receives remarks on a scene that are not errors; null: dropped.
struct SceneRemarks {
  std::vector<std::string>* notes = nullptr;  ///< what is left out at the ends of patterns, and why
  std::string* loose = nullptr;  ///< text on supports that do not hold every part, which is thrown otherwise
};

/// Validates the list (filling in defaults), then names, geometry, and supports, which must hold every part. Throws
/// InputError with all mistakes that do not follow from others; inside ParameterSource::collect() they are kept as long
/// as something allowed can replace them. Adds points that only the end of an arc or helix defines to the scene's
/// points. `path`: place of the list below the root of `source`.
Scene read_scene(Teuchos::ParameterList& scene_list, const ParameterSource& source,
                 const ParameterPath& path = {"Scene"}, const SceneRemarks& remarks = {});

}  // namespace mixbeam

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

/// Where to put what is said of a scene beside the errors of it; null: nowhere.
struct SceneRemarks {
  std::vector<std::string>* notes = nullptr;  ///< what is left out where patterns end, and why
  std::string* loose = nullptr;  ///< what is said of supports that do not hold every part, which is thrown otherwise
};

/// Validates the list (filling in defaults), then everything that names refer to and geometry must satisfy,
/// supports that hold every part included.
/// Throws InputError, of all mistakes that do not follow from others; inside ParameterSource::collect() they wait as
/// long as something that was meant can be read in their place. Points that only the end of an arc or helix reaches are
/// added to the scene's points. `path`: where the list stands below the root of `source`.
Scene read_scene(Teuchos::ParameterList& scene_list, const ParameterSource& source,
                 const ParameterPath& path = {"Scene"}, const SceneRemarks& remarks = {});

}  // namespace mixbeam

/// An error that shows only when a member is divided into elements, where the file that it came from is not known.
#pragma once

#include "discretization/text/errors.hpp"

#include <string>
#include <utility>

namespace mixbeam {

/// Whoever knows the file adds the place (scene_file.hpp).
class MemberError : public InputError {
 public:
  /// `remark`: after the name, such as ", element 1 of 4".
  MemberError(std::string member, const std::string& remark, const std::string& problem)
      : InputError("member \"" + member + "\"" + remark + ": " + problem), member_(std::move(member)) {}

  const std::string& member() const { return member_; }

 private:
  std::string member_;
};

}  // namespace mixbeam

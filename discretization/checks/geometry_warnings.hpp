/// Warnings about connections that were probably meant but are not there.
#pragma once

#include "discretization/checks/survey.hpp"
#include "discretization/text/warning_list.hpp"

namespace mixbeam {

/// Points that all but coincide, members that lie on each other, points that lie on a member which does not know them.
void add_geometry_warnings(const SceneSurvey& survey, WarningList& list);

}  // namespace mixbeam

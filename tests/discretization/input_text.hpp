/// What the tests of the input share: a small valid scene, changes of it, and looking into error messages.
#pragma once

#include "discretization/parameters/validate.hpp"
#include "discretization/parameters/xml_reader.hpp"
#include "discretization/reading/read_scene.hpp"
#include "discretization/reading/scene_reader.hpp"
#include "discretization/text/errors.hpp"
#include "tests/support/text.hpp"

#include <gtest/gtest.h>

#include <string>

namespace mixbeam {

/// A shaft with a bow on top whose end "tip" is not declared: line numbers of the tests below refer to this text.
inline const std::string kBowScene = R"xml(<?xml version="1.0"?>
<ParameterList name="bow">
  <ParameterList name="Scene">
    <ParameterList name="Sections">
      <ParameterList name="steel">
        <Parameter name="EA" type="double" value="1e4"/>
        <Parameter name="GA2" type="double" value="5e3"/>
        <Parameter name="GA3" type="int" value="5000"/>
        <Parameter name="GIt" type="double" value="2"/>
        <Parameter name="EI2" type="double" value="2"/>
        <Parameter name="EI3" type="double" value="2.5"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Points">
      <Parameter name="foot" type="Array(double)" value="{0, 0, 0}"/>
      <Parameter name="top" type="Array(double)" value="{10, 0, 0}"/>
    </ParameterList>
    <ParameterList name="Members">
      <ParameterList name="shaft">
        <Parameter name="Start" type="string" value="foot"/>
        <Parameter name="End" type="string" value="top"/>
        <Parameter name="Section" type="string" value="steel"/>
        <Parameter name="Order" type="int" value="3"/>
        <Parameter name="Elements" type="int" value="4"/>
        <Parameter name="Second Axis" type="Array(double)" value="{0, 1, 0}"/>
      </ParameterList>
      <ParameterList name="arch">
        <Parameter name="Start" type="string" value="top"/>
        <Parameter name="End" type="string" value="tip"/>
        <Parameter name="Section" type="string" value="steel"/>
        <ParameterList name="Curve">
          <Parameter name="Shape" type="string" value="arc"/>
          <Parameter name="Center" type="Array(double)" value="{10, 5, 0}"/>
          <Parameter name="Axis" type="Array(double)" value="{0, 0, 2}"/>
          <Parameter name="Angle" type="double" value="1.5707963267948966"/>
        </ParameterList>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Supports">
      <ParameterList name="clamp">
        <Parameter name="Point" type="string" value="foot"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Point Loads">
      <ParameterList name="pull">
        <Parameter name="Point" type="string" value="tip"/>
        <Parameter name="Force" type="Array(double)" value="{0, 1, 0}"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Distributed Loads">
      <ParameterList name="weight">
        <Parameter name="Member" type="string" value="shaft"/>
        <Parameter name="Force" type="Array(double)" value="{0, 0, -1}"/>
        <Parameter name="Stage" type="int" value="2"/>
      </ParameterList>
    </ParameterList>
  </ParameterList>
</ParameterList>
)xml";

/// What the list "Scene" describes, whether supports hold it or not: read_scene without its last check.
inline Scene described_by(const XmlParameters& xml) {
  Teuchos::ParameterList& list = xml.list->sublist("Scene");
  validate(list, scene_spec(), xml.source, {"Scene"});
  return SceneReader(list, {xml.source, {"Scene"}}).read();
}

inline Scene scene_from(const std::string& text) { return described_by(parse_xml(text, "scene.xml")); }

/// Message of the InputError that `action` throws; empty, and a failure, if it throws none.
template <typename Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

}  // namespace mixbeam

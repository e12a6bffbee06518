/// A scene that uses everything a scene file can say: what the tests of hostile input damage.
#pragma once

#include <string>

namespace mixbeam {

inline const std::string kRichScene = R"xml(<?xml version="1.0" encoding="UTF-8"?>
<ParameterList name="everything">
  <ParameterList name="Scene">
    <Parameter name="Units" type="string" value="m, N"/>
    <Parameter name="Load Cases" type="Array(string)" value="{wind, snow}"/>
    <ParameterList name="Sections">
      <ParameterList name="steel">
        <Parameter name="EA" type="double" value="1e4"/>
        <Parameter name="Shear Rigid" type="bool" value="true"/>
        <Parameter name="GIt" type="int" value="2"/>
        <Parameter name="EI2" type="double" value="2"/>
        <Parameter name="EI3" type="double" value="2.5"/>
      </ParameterList>
      <ParameterList name="tube">
        <Parameter name="Shape" type="string" value="tube"/>
        <Parameter name="Diameter" type="double" value="0.1"/>
        <Parameter name="Wall" type="double" value="0.01"/>
        <Parameter name="Largest Strain" type="double" value="0.1"/>
        <ParameterList name="Material">
          <Parameter name="E" type="double" value="1e6"/>
          <Parameter name="nu" type="double" value="0.3"/>
          <Parameter name="Strength" type="double" value="2e4"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="thin tube">
        <Parameter name="Shape" type="string" value="tube"/>
        <Parameter name="Diameter" type="double" value="0.05"/>
        <Parameter name="Wall" type="double" value="0.01"/>
        <ParameterList name="Material">
          <Parameter name="E" type="double" value="1e6"/>
          <Parameter name="nu" type="double" value="0.3"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="coupled">
        <Parameter name="Matrix" type="Array(double)" value="{100, 0, 0, 1, 0, 0, 50, 0, 0, 0, 0, 50, 0, 0, 0, 3, 0.1, 0, 2, 0, 2}"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Points">
      <Parameter name="foot" type="Array(double)" value="{0, 0, 0}"/>
      <Parameter name="top" type="Array(double)" value="{10, 0, 0}"/>
      <Parameter name="left" type="Array(double)" value="{0, 8, 0}"/>
      <Parameter name="anchor" type="Array(double)" value="{10, 0, -6}"/>
    </ParameterList>
    <ParameterList name="Members">
      <ParameterList name="shaft">
        <Parameter name="Start" type="string" value="foot"/>
        <Parameter name="End" type="string" value="top"/>
        <Parameter name="Section" type="string" value="tube"/>
        <Parameter name="End Section" type="string" value="thin tube"/>
        <Parameter name="Taper" type="string" value="x^2"/>
        <Parameter name="Order" type="int" value="3"/>
        <Parameter name="Elements" type="int" value="4"/>
        <Parameter name="Twist" type="double" value="0.5"/>
        <Parameter name="Second Axis" type="Array(double)" value="{0, 1, 0}"/>
        <ParameterList name="Inner Points">
          <Parameter name="middle" type="double" value="0.5"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="arch">
        <Parameter name="Start" type="string" value="top"/>
        <Parameter name="End" type="string" value="tip"/>
        <Parameter name="Section" type="string" value="steel"/>
        <Parameter name="Elements" type="int" value="3"/>
        <Parameter name="Stations" type="Array(double)" value="{0, 0.2, 0.6, 1}"/>
        <ParameterList name="Curve">
          <Parameter name="Shape" type="string" value="arc"/>
          <Parameter name="Center" type="Array(double)" value="{10, 5, 0}"/>
          <Parameter name="Axis" type="Array(double)" value="{0, 0, 2}"/>
          <Parameter name="Angle" type="double" value="1.5707963267948966"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="coil">
        <Parameter name="Start" type="string" value="tip"/>
        <Parameter name="End" type="string" value="coil end"/>
        <Parameter name="Section" type="string" value="coupled"/>
        <Parameter name="Force Integration" type="string" value="full"/>
        <ParameterList name="Curve">
          <Parameter name="Shape" type="string" value="helix"/>
          <Parameter name="Center" type="Array(double)" value="{10, 5, 0}"/>
          <Parameter name="Axis" type="Array(double)" value="{0, 0, 1}"/>
          <Parameter name="Angle" type="double" value="9"/>
          <Parameter name="Rise" type="double" value="2"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="strut 1">
        <Parameter name="Start" type="string" value="middle"/>
        <Parameter name="End" type="string" value="left"/>
        <Parameter name="Section" type="string" value="steel"/>
        <ParameterList name="Curve">
          <Parameter name="Shape" type="string" value="spline"/>
          <Parameter name="Through" type="Array(double)" value="{4, 3, 1, 2, 6, 1}"/>
          <Parameter name="Start Tangent" type="Array(double)" value="{0, 1, 0}"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="strut 2">
        <Parameter name="Start" type="string" value="foot"/>
        <Parameter name="End" type="string" value="left"/>
        <Parameter name="Section" type="string" value="steel"/>
        <ParameterList name="Curve">
          <Parameter name="Shape" type="string" value="parametric"/>
          <Parameter name="Formula" type="Array(string)" value="{sin(pi*t), 8*t, max(0, t*(1 - t))}"/>
          <Parameter name="Range" type="Array(double)" value="{0, 1}"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="cable">
        <Parameter name="Start" type="string" value="top"/>
        <Parameter name="End" type="string" value="anchor"/>
        <Parameter name="Section" type="string" value="steel"/>
        <ParameterList name="Curve">
          <Parameter name="Shape" type="string" value="polyline"/>
          <Parameter name="Through" type="Array(double)" value="{10, 0.5, -2, 10, 0.5, -4}"/>
        </ParameterList>
      </ParameterList>
      <ParameterList name="bow">
        <Parameter name="Start" type="string" value="left"/>
        <Parameter name="End" type="string" value="coil end"/>
        <Parameter name="Section" type="string" value="steel"/>
        <Parameter name="Elements" type="int" value="2"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Patterns">
      <ParameterList name="storeys">
        <Parameter name="Members" type="Array(string)" value="{bow}"/>
        <Parameter name="Kind" type="string" value="repeat"/>
        <Parameter name="Vector" type="Array(double)" value="{0, 0, 3}"/>
        <Parameter name="Count" type="int" value="3"/>
      </ParameterList>
      <ParameterList name="star">
        <Parameter name="Members" type="Array(string)" value="{bow}"/>
        <Parameter name="Kind" type="string" value="rotate"/>
        <Parameter name="Center" type="Array(double)" value="{0, 8, 0}"/>
        <Parameter name="Axis" type="Array(double)" value="{0, 0, 1}"/>
        <Parameter name="Angle" type="double" value="0.5"/>
        <Parameter name="Count" type="int" value="2"/>
      </ParameterList>
      <ParameterList name="image">
        <Parameter name="Members" type="Array(string)" value="{bow}"/>
        <Parameter name="Kind" type="string" value="mirror"/>
        <Parameter name="Point" type="Array(double)" value="{0, 9, 0}"/>
        <Parameter name="Normal" type="Array(double)" value="{0, 1, 0}"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Supports">
      <ParameterList name="copies">
        <Parameter name="Point" type="string" value="left (*"/>
      </ParameterList>
      <ParameterList name="clamp">
        <Parameter name="Point" type="string" value="foot"/>
      </ParameterList>
      <ParameterList name="bearing">
        <Parameter name="Point" type="string" value="anch*"/>
        <Parameter name="Axes" type="Array(double)" value="{1, 1, 0, 0, 0, 2}"/>
        <Parameter name="Fixed Displacement" type="Array(string)" value="{x, z}"/>
        <Parameter name="Fixed Rotation" type="Array(string)" value="{y}"/>
        <Parameter name="Prescribed Displacement" type="Array(double)" value="{0, 0, 0.5}"/>
        <Parameter name="Displacement Stiffness" type="Array(double)" value="{0, 3, 0}"/>
        <Parameter name="Rotation Stiffness" type="Array(double)" value="{1, 0, 2}"/>
        <Parameter name="Amplitude" type="string" value="sin(pi/2*t)"/>
        <Parameter name="Case" type="string" value="snow"/>
      </ParameterList>
      <ParameterList name="turned">
        <Parameter name="Point" type="string" value="coil end"/>
        <Parameter name="Prescribed Rotation" type="Array(double)" value="{0, 0, 0.1}"/>
        <Parameter name="Stage" type="int" value="2"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Joints">
      <ParameterList name="pin">
        <Parameter name="Point" type="string" value="left"/>
        <Parameter name="Members" type="Array(string)" value="{strut *}"/>
        <Parameter name="Kind" type="string" value="hinge"/>
        <Parameter name="Axis" type="Array(double)" value="{0, 0, 1}"/>
        <Parameter name="Stiffness" type="double" value="0.1"/>
      </ParameterList>
      <ParameterList name="socket">
        <Parameter name="Point" type="string" value="tip"/>
        <Parameter name="Members" type="Array(string)" value="{coil}"/>
        <Parameter name="Kind" type="string" value="ball"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Point Loads">
      <ParameterList name="pull">
        <Parameter name="Point" type="string" value="tip"/>
        <Parameter name="Force" type="Array(double)" value="{0, 1, 0}"/>
        <Parameter name="Moment" type="Array(double)" value="{0, 0.1, 0}"/>
        <Parameter name="Amplitude" type="string" value="t &gt; 1 ? 1 : t"/>
      </ParameterList>
      <ParameterList name="thrust">
        <Parameter name="Point" type="string" value="middle"/>
        <Parameter name="Force" type="Array(double)" value="{0, 1, 0}"/>
        <Parameter name="Frame" type="string" value="follower"/>
        <Parameter name="Member" type="string" value="strut*"/>
        <Parameter name="Case" type="string" value="wind"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Distributed Loads">
      <ParameterList name="weight">
        <Parameter name="Member" type="string" value="*"/>
        <Parameter name="Force" type="Array(double)" value="{0, 0, -1}"/>
        <Parameter name="Stage" type="int" value="1"/>
      </ParameterList>
      <ParameterList name="pressure">
        <Parameter name="Member" type="string" value="shaft"/>
        <Parameter name="Force Formula" type="Array(string)" value="{0, max(s, 1), -2*(1 - x)}"/>
        <Parameter name="Couple" type="Array(double)" value="{0.1, 0, 0}"/>
        <Parameter name="Frame" type="string" value="follower"/>
        <Parameter name="Case" type="string" value="wind"/>
        <Parameter name="Stage" type="int" value="2"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Eigenstrains">
      <ParameterList name="heat">
        <Parameter name="Member" type="string" value="shaft"/>
        <Parameter name="Temperature" type="double" value="100"/>
        <Parameter name="Expansion Coefficient" type="double" value="1.2e-5"/>
        <Parameter name="Curvature Formula" type="Array(string)" value="{0, 0, exp(-s)}"/>
        <Parameter name="Stage" type="int" value="2"/>
      </ParameterList>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Expected">
    <ParameterList name="force at the foot">
      <Parameter name="Quantity" type="string" value="reaction force"/>
      <Parameter name="Point" type="string" value="foot"/>
      <Parameter name="Component" type="string" value="norm"/>
      <Parameter name="Case" type="string" value="snow"/>
      <Parameter name="Value" type="double" value="2.5"/>
      <Parameter name="Relative Tolerance" type="double" value="1e-6"/>
      <Parameter name="Source" type="string" value="none, a scene for tests of input"/>
    </ParameterList>
    <ParameterList name="moment of the shaft">
      <Parameter name="Quantity" type="string" value="material moment"/>
      <Parameter name="Member" type="string" value="shaft"/>
      <Parameter name="Position" type="double" value="0.5"/>
      <Parameter name="Component" type="string" value="3"/>
      <Parameter name="Load Factor" type="double" value="1"/>
      <Parameter name="Case" type="string" value="wind"/>
      <Parameter name="Value" type="double" value="0.1"/>
      <Parameter name="Absolute Tolerance" type="double" value="1"/>
      <Parameter name="Source" type="string" value="none"/>
    </ParameterList>
  </ParameterList>
</ParameterList>
)xml";

}  // namespace mixbeam

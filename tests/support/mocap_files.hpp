#pragma once

namespace wholehand::test {

// Three samples of OptiTrack Motive and four of Vicon Nexus, laid out as their manuals describe.
inline constexpr const char* kMotive =
    "Format Version,1.23,Take Name,reach,Capture Frame Rate,100.000000,Rotation Type,XYZ,"
    "Length Units,Millimeters,Coordinate Space,Global\n"
    "\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n"
    ",Name,Wrist,Wrist,Wrist,Wrist,Wrist,Wrist\n"
    ",ID,1,1,1,1,1,1\n"
    ",,Rotation,Rotation,Rotation,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,X,Y,Z\n"
    "0,0.000000,90,0,0,100,200,300\n"
    "1,0.010000,90,0,0,110,200,300\n"
    "2,0.020000,90,0,0,120,200,310\n";

inline constexpr const char* kNexus =
    "Trajectories\n"
    "200\n"
    ",,Left:RWRI,,,Left:RFIN,,\n"
    "Frame,Sub Frame,X,Y,Z,X,Y,Z\n"
    ",,mm,mm,mm,mm,mm,mm\n"
    "100,0,1,2,3,4,5,6\n"
    "101,0,,,,4,5,6\n"
    "102,0,2,2,3,4,5,6\n"
    "103,0,3,2,3,,,\n";

}  // namespace wholehand::test

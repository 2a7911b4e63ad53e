#pragma once
#include <string>
#include <string_view>

namespace supple::io {

/// Arrays in VTK files that hold names: "region:NAME" (one number, the tag) among the fields, "group:NAME" (0 or 1) of the points.
inline constexpr std::string_view kRegionArray = "region", kRegionPrefix = "region:", kGroupPrefix = "group:";

/// Names of arrays in legacy files have no blanks, quotes or percent signs: those stand as %20 and so on.
std::string encode_vtk_name(std::string_view name);
std::string decode_vtk_name(std::string_view name);

/// Text inside an XML attribute, and back.
std::string escape_xml(std::string_view text);
std::string unescape_xml(std::string_view text);

}  // namespace supple::io

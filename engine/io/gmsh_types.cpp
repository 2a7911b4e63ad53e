#include <algorithm>

#include "supple/io/gmsh_parts.h"

namespace supple::io {

namespace {

// Codes, dimensions and vertex counts: Gmsh reference manual, "MSH file format", element types.
constexpr ElementType kTypes[] = {
    {1, "2-node line", 1, 2},           {2, "3-node triangle", 2, 3},       {3, "4-node quadrangle", 2, 4},
    {4, "4-node tetrahedron", 3, 4},    {5, "8-node hexahedron", 3, 8},     {6, "6-node prism", 3, 6},
    {7, "5-node pyramid", 3, 5},        {8, "3-node line", 1, 3},           {9, "6-node triangle", 2, 6},
    {10, "9-node quadrangle", 2, 9},    {11, "10-node tetrahedron", 3, 10}, {12, "27-node hexahedron", 3, 27},
    {13, "18-node prism", 3, 18},       {14, "14-node pyramid", 3, 14},     {15, "point", 0, 1},
    {16, "8-node quadrangle", 2, 8},    {17, "20-node hexahedron", 3, 20},  {18, "15-node prism", 3, 15},
    {19, "13-node pyramid", 3, 13},     {20, "9-node triangle", 2, 9},      {21, "10-node triangle", 2, 10},
    {22, "12-node triangle", 2, 12},    {23, "15-node triangle", 2, 15},    {24, "15-node triangle", 2, 15},
    {25, "21-node triangle", 2, 21},    {26, "4-node line", 1, 4},          {27, "5-node line", 1, 5},
    {28, "6-node line", 1, 6},          {29, "20-node tetrahedron", 3, 20}, {30, "35-node tetrahedron", 3, 35},
    {31, "56-node tetrahedron", 3, 56}, {36, "16-node quadrangle", 2, 16},  {37, "25-node quadrangle", 2, 25},
    {38, "36-node quadrangle", 2, 36},  {92, "64-node hexahedron", 3, 64},  {93, "125-node hexahedron", 3, 125},
};

}  // namespace

const ElementType& gmsh_element_type(const TextScanner& scanner, const char* position, std::int64_t code) {
    const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes), [&](const ElementType& t) { return t.code == code; });
    if (type == std::end(kTypes)) {
        scanner.fail("Gmsh element type " + std::to_string(code) + " is not known; tetrahedra (4) and hexahedra (5) can be simulated",
                     position, ErrorCode::unsupported);
    }
    if (type->dimension < 3 || type->code == 4 || type->code == 5) return *type;
    const std::string what = "a " + std::string(type->name) + " (Gmsh element type " + std::to_string(code) + ") cannot be simulated; ";
    const bool linear = type->code == 6 || type->code == 7;
    scanner.fail(what + (linear ? "mesh the part with tetrahedra or hexahedra (in Gmsh: no extrusion with Recombine, or split with "
                                  "Mesh.SubdivisionAlgorithm)"
                                : "save the mesh with first-order elements (in Gmsh: Mesh.ElementOrder = 1, or gmsh -order 1)"),
                 position, ErrorCode::unsupported);
}

}  // namespace supple::io

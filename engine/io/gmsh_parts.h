#pragma once
#include <bit>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "supple/io/mesh_builder.h"

namespace supple::io {

/// @error Error(unsupported) at the scanner's line if the code is unknown or is that of a volume element other than tet4 and hex8
const ElementType& gmsh_element_type(const TextScanner& scanner, const char* position, std::int64_t code);

/// The parts of the file that each version reads in its own way; the scanners stand behind the section's head line.
void read_gmsh2_nodes(TextScanner& scanner, MeshBuilder& builder, bool parametric);
void read_gmsh2_elements(TextScanner& scanner, MeshBuilder& builder, bool version1);

/// Physical tags of each entity (dimension, tag).
using GmshEntities = std::map<std::pair<int, std::int64_t>, std::vector<std::int64_t>>;
GmshEntities read_gmsh4_entities(TextScanner& scanner);
void read_gmsh4_nodes(TextScanner& scanner, MeshBuilder& builder);
void read_gmsh4_elements(TextScanner& scanner, MeshBuilder& builder, const GmshEntities& entities);

/// The same from bytes.
void read_gmsh2_nodes_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder);
void read_gmsh2_elements_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder);
GmshEntities read_gmsh4_entities_binary(TextScanner& scanner, std::endian order);
void read_gmsh4_nodes_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder);
void read_gmsh4_elements_binary(TextScanner& scanner, std::endian order, MeshBuilder& builder, const GmshEntities& entities);

/// A section of element data; taken where it is called "fill".
void read_gmsh_fill(TextScanner& scanner, bool binary, std::endian order, MeshBuilder& builder);

}  // namespace supple::io

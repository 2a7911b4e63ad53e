#pragma once
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "supple/io/vtk_grid.h"
#include "supple/io/xml_tags.h"

namespace supple::io {

/// How the arrays of a VTK XML file are stored, and where its appended ones are.
struct VtuStorage {
    std::endian order = std::endian::little;
    int header_bytes = 4;
    bool zlib = false;
    bool appended_base64 = false;
    const char* appended = nullptr;  ///< behind the underscore; null where there are none
    const char* end = nullptr;       ///< of the appended data: the end of the file, or of the base64 text
};

/// Reads the attributes of <VTKFile>. @error Error(unsupported) for compressors other than zlib
VtuStorage read_vtu_storage(const TextScanner& file, std::string_view text, const XmlTag& head);

/// The values of a <DataArray>, from text, base64 or bytes (VTK's documentation, "VTK XML Formats"): a size in front, or for zlib the sizes
/// of blocks. @error Error(parse) at the tag's line where sizes and data do not fit, Error(unsupported) for an unknown type or format
Numbers read_vtu_integers(const TextScanner& file, const VtuStorage& storage, const XmlTag& array);
std::vector<double> read_vtu_reals(const TextScanner& file, const VtuStorage& storage, const XmlTag& array,
                                   std::vector<const char*>& positions);

}  // namespace supple::io

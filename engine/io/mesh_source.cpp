#include "supple/io/mesh_source.h"

#include "supple/base/error.h"
#include "supple/io/binary_file.h"

namespace supple::io {

std::string read_partner(const MeshSource& source, const std::filesystem::path& partner, const std::string& where) {
    if (source.folder.empty())
        throw Error(ErrorCode::unsupported, where,
                    "the file " + partner.string() + " belongs to this mesh; read it from a file, not from memory");
    const std::filesystem::path file = source.folder / partner;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored))
        throw Error(ErrorCode::file_unreadable, where,
                    "the file " + file.string() + " belongs to this mesh and is not there; put it beside this one");
    try {
        return read_text_file(file);
    } catch (const Error& error) {
        throw Error(error.code(), where, error.what());
    }
}

}  // namespace supple::io

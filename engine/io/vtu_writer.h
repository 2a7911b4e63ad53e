#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "supple/io/volume_formats.h"

namespace supple::io {

/// Writes a VTK XML unstructured grid array by array: field data, then points, cells, and data of points and cells.
class VtuWriter {
public:
    explicit VtuWriter(VtuEncoding encoding) : encoding_(encoding) {}

    void field(std::string_view name, std::int32_t value);
    void point_data(std::string_view name, int components, std::span<const double> values);
    void point_data(std::string_view name, std::span<const std::uint8_t> values);
    void cell_data(std::string_view name, int components, std::span<const double> values);
    void cell_data(std::string_view name, std::span<const std::int32_t> values);
    /// Ends the file: tets, then hexes.
    std::string finish(std::span<const Vec3> points, std::span<const Tet> tets, std::span<const Hex> hexes);

private:
    template <class T>
    void add(std::string& xml, const char* type, std::string_view name, int components, std::span<const T> values);
    std::string packed(std::string_view bytes) const;

    VtuEncoding encoding_;
    std::string fields_, point_data_, cell_data_, appended_;
};

}  // namespace supple::io

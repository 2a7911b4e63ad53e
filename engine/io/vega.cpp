#include "supple/io/element_sets.h"
#include "supple/io/keyword_lines.h"
#include "supple/io/volume_formats.h"

namespace supple::io {

namespace {

class Vega {
public:
    explicit Vega(const MeshSource& source) : reader_(source, "#", true) {}

    void read(MeshBuilder& builder) {
        KeywordLine line;
        while (reader_.next(line)) {
            if (line.is_keyword()) {
                begin_section(line);
            } else if (section_ == "vertices") {
                read_vertex(line, builder);
            } else if (section_ == "elements") {
                read_element(line);
            } else if (section_ == "set") {
                for (std::size_t f = 0; f < line.fields.size(); ++f)
                    if (!line.fields[f].empty()) sets_.set(set_).push_back(line.integer(f, "the number of an element"));
            } else if (section_ == "region") {
                regions_.push_back(std::string(line.fields[0]));  // set, material
            } else if (section_.empty()) {
                line.fail("a section such as *VERTICES must begin here, found " + quoted(line.fields[0]));
            }
        }
        if (vertices_ < 0) reader_.file().fail("the file has no *VERTICES");
        if (vertices_ > 0)
            reader_.file().fail(std::to_string(vertices_) + " vertices are missing: the file is truncated, or the count is wrong");
        if (elements_ > 0)
            reader_.file().fail(std::to_string(elements_) + " elements are missing: the file is truncated, or the count is wrong");
        builder.close_vertices(reader_.file());
        sets_.feed(reader_.file(), regions_, builder);
    }

private:
    void begin_section(const KeywordLine& line) {
        const std::string keyword = line.keyword();
        if (keyword == "include") {
            if (line.fields.size() < 2) line.fail("*INCLUDE names no file");
            return reader_.include(line, line.fields[1]);
        }
        section_ = keyword;
        has_head_ = false;
        type_ = nullptr;
        if (keyword != "set") return;
        if (line.fields.size() < 2 || line.fields[1].empty()) line.fail("the set has no name");
        set_ = std::string(line.fields[1]);
        sets_.set(set_);
    }

    void read_vertex(const KeywordLine& line, MeshBuilder& builder) {
        if (!has_head_) {
            has_head_ = true;
            if (vertices_ >= 0) line.fail("a second section *VERTICES; only one is allowed");
            vertices_ = line.integer(0, "the number of vertices");
            if (vertices_ < 0) line.fail("the number of vertices is negative");
            if (line.integer(1, "the dimension") != 3) line.fail("the dimension must be 3, found " + quoted(line.fields[1]));
            return;
        }
        if (vertices_-- == 0) line.fail("there are more vertices than *VERTICES announces");
        Vec3 x;
        for (int axis = 0; axis < 3; ++axis) x[axis] = line.real(std::size_t(axis) + 1, "a coordinate of a vertex");
        const bool outer = line.scanner == &reader_.file();  // places in other files cannot be told later
        builder.add_vertex(line.integer(0, "the number of a vertex"), x, outer ? line.position : nullptr);
    }

    void read_element(const KeywordLine& line) {
        if (!type_) {
            const std::string name = plain_lower(line.fields[0]);
            if (name == "tet" || name == "tets") type_ = &kTetType;
            if (name == "cubic" || name == "cube" || name == "hex") type_ = &kHexType;
            if (!type_)
                line.fail("elements of the type " + quoted(line.fields[0]) + " are not known; TET and CUBIC are", ErrorCode::unsupported);
            return;
        }
        if (!has_head_) {
            has_head_ = true;
            elements_ = line.integer(0, "the number of elements");
            if (elements_ < 0) line.fail("the number of elements is negative");
            if (line.integer(1, "the number of vertices of an element") != type_->vertex_count)
                line.fail("a " + std::string(type_->name) + " has " + std::to_string(type_->vertex_count) + " vertices, found " +
                          quoted(line.fields[1]));
            return;
        }
        if (elements_-- == 0) line.fail("there are more elements than *ELEMENTS announces");
        std::int64_t ids[8];
        for (int v = 0; v < type_->vertex_count; ++v) ids[v] = line.integer(std::size_t(v) + 1, "a vertex of an element");
        sets_.add_element(line.integer(0, "the number of an element"), *type_, {ids, std::size_t(type_->vertex_count)}, *line.scanner,
                          line.position);
    }

    KeywordReader reader_;
    ElementSets sets_;
    std::vector<std::string> regions_;
    std::string section_, set_;
    bool has_head_ = false;
    const ElementType* type_ = nullptr;
    std::int64_t vertices_ = -1, elements_ = 0;  ///< left to read
};

}  // namespace

void read_vega(const MeshSource& source, MeshBuilder& builder) { Vega(source).read(builder); }

}  // namespace supple::io

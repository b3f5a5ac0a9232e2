#include "golden/form.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <vector>

namespace wholehand::golden {

namespace {

using reflection::BaseType;
using reflection::Schema;

constexpr const char* kPackage = "wholehand.protocol.";

std::string shortName(const std::string& name) {
  return name.starts_with(kPackage) ? name.substr(std::string(kPackage).size()) : name;
}

/// A scalar type: its name in the layout and its format in the canonical form. 64-bit integers and
/// floating-point numbers are written as bits, because JSON readers round them.
struct Scalar {
  const char* name;
  std::string (*form)(const std::uint8_t* at);
};

template <class T>
std::string number(const std::uint8_t* at) {
  return std::to_string(flatbuffers::ReadScalar<T>(at));
}
template <class T>
std::string bits(const std::uint8_t* at) {
  return fmt::format("\"{:0{}x}\"", flatbuffers::ReadScalar<T>(at), 2 * sizeof(T));
}
std::string truth(const std::uint8_t* at) {
  return *at != 0 ? "true" : "false";
}

/// The scalar type, or nullptr if it is none.
const Scalar* scalarOf(BaseType type) {
  static const std::map<BaseType, Scalar> kScalars = {
      {BaseType::Bool, {"bool", truth}},
      {BaseType::Byte, {"i8", number<std::int8_t>}},
      {BaseType::UByte, {"u8", number<std::uint8_t>}},
      {BaseType::UType, {"u8", number<std::uint8_t>}},
      {BaseType::Short, {"i16", number<std::int16_t>}},
      {BaseType::UShort, {"u16", number<std::uint16_t>}},
      {BaseType::Int, {"i32", number<std::int32_t>}},
      {BaseType::UInt, {"u32", number<std::uint32_t>}},
      {BaseType::Long, {"i64", bits<std::uint64_t>}},
      {BaseType::ULong, {"u64", bits<std::uint64_t>}},
      {BaseType::Float, {"f32", bits<std::uint32_t>}},
      {BaseType::Double, {"f64", bits<std::uint64_t>}}};
  const auto found = kScalars.find(type);
  return found == kScalars.end() ? nullptr : &found->second;
}

std::string defaultOf(const reflection::Field& field) {
  const BaseType type = field.type()->base_type();
  const std::int64_t integer = field.default_integer();
  const auto as_float = static_cast<float>(field.default_real());
  const double real = field.default_real();
  const void* value = &integer;
  if (type == BaseType::Float) value = &as_float;
  if (type == BaseType::Double) value = &real;
  return scalarOf(type)->form(static_cast<const std::uint8_t*>(value));
}

/// Fields in the order of their ids; reflection gives them in the order of their names.
std::vector<const reflection::Field*> fieldsOf(const reflection::Object& object) {
  std::vector<const reflection::Field*> fields(object.fields()->begin(), object.fields()->end());
  std::sort(fields.begin(), fields.end(),
            [](const auto* a, const auto* b) { return a->id() < b->id(); });
  return fields;
}

class Reader {
 public:
  explicit Reader(const Schema& schema) : schema_(schema) {}

  std::string table(const flatbuffers::Table& table, const reflection::Object& object) const {
    std::string members;
    for (const auto* field : fieldsOf(object)) {
      const std::string value = fieldOf(table, object, *field);
      if (!value.empty()) append(members, quoted(field->name()->str()) + ":" + value);
    }
    return "{" + members + "}";
  }

 private:
  static void append(std::string& list, const std::string& item) {
    if (!list.empty()) list += ",";
    list += item;
  }

  const reflection::Object& objectOf(const reflection::Type& type) const {
    return *schema_.objects()->Get(static_cast<flatbuffers::uoffset_t>(type.index()));
  }

  /// The field's form; empty if the field is absent, empty or has its default.
  std::string fieldOf(const flatbuffers::Table& table, const reflection::Object& object,
                      const reflection::Field& field) const {
    const std::uint8_t* at = table.GetAddressOf(field.offset());
    const BaseType type = field.type()->base_type();
    if (at == nullptr || type == BaseType::UType) return "";
    if (const Scalar* scalar = scalarOf(type)) {
      std::string value = scalar->form(at);
      return value == defaultOf(field) ? "" : value;
    }
    if (type == BaseType::Union) return unionOf(table, object, field);
    if (type == BaseType::Vector) return vector(target(at), *field.type());
    if (type == BaseType::String) return string(at) == "\"\"" ? "" : string(at);
    return element(at, BaseType::Obj, *field.type());
  }

  std::string unionOf(const flatbuffers::Table& table, const reflection::Object& object,
                      const reflection::Field& field) const {
    const auto* which = object.fields()->LookupByKey((field.name()->str() + "_type").c_str());
    const auto value = table.GetField<std::uint8_t>(which->offset(), 0);
    const auto* members =
        schema_.enums()->Get(static_cast<flatbuffers::uoffset_t>(field.type()->index()));
    const auto* member = members->values()->LookupByKey(value);
    if (value == 0 || member == nullptr) return "";
    const auto* object_of_member = &objectOf(*member->union_type());
    return "{" + quoted(shortName(member->name()->str())) + ":" +
           this->table(*flatbuffers::GetFieldT(table, field), *object_of_member) + "}";
  }

  static const std::uint8_t* target(const std::uint8_t* at) {
    return at + flatbuffers::ReadScalar<flatbuffers::uoffset_t>(at);
  }

  static std::string string(const std::uint8_t* at) {
    return quoted(reinterpret_cast<const flatbuffers::String*>(target(at))->str());
  }

  std::string vector(const std::uint8_t* at, const reflection::Type& type) const {
    const auto count = flatbuffers::ReadScalar<flatbuffers::uoffset_t>(at);
    const std::size_t size = flatbuffers::GetTypeSizeInline(type.element(), type.index(), schema_);
    std::string items;
    for (std::size_t i = 0; i < count; ++i) {
      append(items, element(at + sizeof count + i * size, type.element(), type));
    }
    return count == 0 ? "" : "[" + items + "]";
  }

  std::string element(const std::uint8_t* at, BaseType type, const reflection::Type& of) const {
    if (type == BaseType::String) return string(at);
    if (type != BaseType::Obj) return scalarOf(type)->form(at);
    const auto& object = objectOf(of);
    if (object.is_struct()) return structOf(at, object);
    return table(*reinterpret_cast<const flatbuffers::Table*>(target(at)), object);
  }

  std::string structOf(const std::uint8_t* at, const reflection::Object& object) const {
    std::string members;
    for (const auto* field : fieldsOf(object)) {
      append(members,
             quoted(field->name()->str()) + ":" +
                 element(at + field->offset(), field->type()->base_type(), *field->type()));
    }
    return "{" + members + "}";
  }

  const Schema& schema_;
};

std::string kindOf(const Schema& schema, BaseType type, int index) {
  if (const Scalar* scalar = scalarOf(type)) return scalar->name;
  if (type == BaseType::String) return "string";
  if (type == BaseType::Union) return "union";
  if (type == BaseType::Vector) return "vector";
  if (type != BaseType::Obj) throw std::runtime_error("a type that the form does not have");
  return schema.objects()->Get(static_cast<flatbuffers::uoffset_t>(index))->is_struct() ? "struct"
                                                                                        : "table";
}

std::string fieldLayout(const Schema& schema, const reflection::Field& field) {
  const auto& type = *field.type();
  const auto index = static_cast<flatbuffers::uoffset_t>(std::max(type.index(), 0));
  const bool vector = type.base_type() == BaseType::Vector;
  const BaseType of = vector ? type.element() : type.base_type();
  std::string out = fmt::format(R"({{"name":{},"id":{},"offset":{},"kind":"{}")",
                                quoted(field.name()->str()), field.id(), field.offset(),
                                type.base_type() == BaseType::UType
                                    ? "utype"
                                    : kindOf(schema, type.base_type(), type.index()));
  if (vector) out += fmt::format(R"(,"element":"{}")", kindOf(schema, of, type.index()));
  if (of == BaseType::Obj) {
    out += ",\"of\":" + quoted(shortName(schema.objects()->Get(index)->name()->str()));
  } else if (type.index() >= 0) {
    out += ",\"of\":" + quoted(shortName(schema.enums()->Get(index)->name()->str()));
  }
  if (scalarOf(type.base_type()) != nullptr) out += ",\"default\":" + defaultOf(field);
  return out + "}";
}

}  // namespace

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += std::string("\\") + c;
    } else if (static_cast<unsigned char>(c) < ' ') {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string layoutOf(const Schema& schema, int schema_version) {
  std::string objects;
  for (const auto* object : *schema.objects()) {
    std::string fields;
    for (const auto* field : fieldsOf(*object)) {
      fields += (fields.empty() ? "" : ",\n  ") + fieldLayout(schema, *field);
    }
    objects += fmt::format("{}{}:{{\"struct\":{},\"size\":{},\"align\":{},\"fields\":[\n  {}]}}",
                           objects.empty() ? "" : ",\n", quoted(shortName(object->name()->str())),
                           object->is_struct(), object->bytesize(), object->minalign(), fields);
  }
  std::string enums;
  for (const auto* e : *schema.enums()) {
    std::string values;
    for (const auto* value : *e->values()) {
      values += fmt::format("{}{}:{}", values.empty() ? "" : ",",
                            quoted(shortName(value->name()->str())), value->value());
    }
    enums += fmt::format("{}{}:{{\"union\":{},\"values\":{{{}}}}}", enums.empty() ? "" : ",\n",
                         quoted(shortName(e->name()->str())), e->is_union(), values);
  }
  return fmt::format("{{\"schema_version\":{},\n\"objects\":{{\n", schema_version) + objects +
         "},\n\"enums\":{\n" + enums + "}}\n";
}

std::string formOf(const Schema& schema, std::span<const std::uint8_t> message) {
  return Reader(schema).table(*flatbuffers::GetRoot<flatbuffers::Table>(message.data()),
                              *schema.root_table());
}

}  // namespace wholehand::golden

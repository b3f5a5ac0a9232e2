using System;
using System.Collections;
using System.Collections.Generic;
using System.Linq;

/// <summary>Converts tables as the client gives them to a game to the canonical form.</summary>
internal sealed class Form
{
    private readonly Dictionary<string, object> objects;

    public Form(Dictionary<string, object> layout)
    {
        objects = (Dictionary<string, object>)layout["objects"];
    }

    public IEnumerable<Dictionary<string, object>> FieldsOf(string table)
    {
        return ((List<object>)((Dictionary<string, object>)objects[table])["fields"]).Cast<Dictionary<string, object>>();
    }

    // The field's name as flatc writes it; no member has the name of its class.
    private static string Member(object table, string field)
    {
        string name = string.Concat(field.Split('_').Select(part => char.ToUpperInvariant(part[0]) + part.Substring(1)));
        return name == table.GetType().Name ? name + "_" : name;
    }

    public Dictionary<string, object> Table(string name, object table)
    {
        var form = new Dictionary<string, object>();
        foreach (Dictionary<string, object> field in FieldsOf(name))
        {
            var kind = (string)field["kind"];
            if (kind == "utype" || kind == "union") continue; // a field of commands, which this client only writes
            object value = kind == "vector" ? Vector(field, table) : Element(kind, field, Get(table, (string)field["name"]));
            if (!IsDefault(field, kind, value)) form[(string)field["name"]] = value;
        }
        return form;
    }

    public static bool IsDefault(Dictionary<string, object> field, string kind, object value)
    {
        if (value == null) return true;
        if (kind == "string") return (string)value == "";
        if (kind == "vector") return ((IList)value).Count == 0;
        return field.TryGetValue("default", out object byDefault) && Json.Write(value) == Json.Write(byDefault);
    }

    private static object Get(object table, string field)
    {
        return table.GetType().GetProperty(Member(table, field)).GetValue(table, null);
    }

    private List<object> Vector(Dictionary<string, object> field, object table)
    {
        string name = Member(table, (string)field["name"]);
        var count = (int)table.GetType().GetProperty(name + "Length").GetValue(table, null);
        var at = table.GetType().GetMethod(name, new[] { typeof(int) });
        // More elements than a message can hold; a game would notice when it reads them.
        if (count < 0 || count > 1000000) throw new InvalidOperationException("a vector that no message has");
        return Enumerable.Range(0, count).Select(i => Element((string)field["element"], field,
            at.Invoke(table, new object[] { i }))).ToList();
    }

    public object Element(string kind, Dictionary<string, object> field, object value)
    {
        if (value == null) return null;
        if (kind == "table") return Table((string)field["of"], value);
        if (kind == "struct") return Struct((string)field["of"], value);
        return kind == "string" ? value : Scalar(value);
    }

    private object Struct(string name, object value)
    {
        return FieldsOf(name).ToDictionary(f => (string)f["name"], f => Element((string)f["kind"], f, Get(value, (string)f["name"])));
    }

    public static object Scalar(object value)
    {
        if (value is bool) return value;
        if (value is float) return BitConverter.ToInt32(BitConverter.GetBytes((float)value), 0).ToString("x8");
        if (value is double) return BitConverter.DoubleToInt64Bits((double)value).ToString("x16");
        if (value is long) return ((long)value).ToString("x16");
        if (value is ulong) return ((ulong)value).ToString("x16");
        return Convert.ToInt64(value);
    }
}

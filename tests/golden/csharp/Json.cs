using System;
using System.Collections.Generic;
using System.Globalization;
using System.Linq;
using System.Text;

/// <summary>Reads and writes the runner's JSON: objects, lists, strings, numbers (double), true, false. mono has no reader.</summary>
internal sealed class Json
{
    private readonly string text;
    private int at;

    private Json(string text)
    {
        this.text = text;
    }

    public static object Read(string text)
    {
        return new Json(text).Value();
    }

    public static string Write(object value)
    {
        if (value == null) return "null";
        if (value is bool) return (bool)value ? "true" : "false";
        var members = value as IDictionary<string, object>;
        if (members != null) return "{" + string.Join(",", members.Select(m => Quoted(m.Key) + ":" + Write(m.Value))) + "}";
        var items = value as List<object>;
        if (items != null) return "[" + string.Join(",", items.Select(Write)) + "]";
        var words = value as string;
        return words != null ? Quoted(words) : Convert.ToString(value, CultureInfo.InvariantCulture);
    }

    private static string Quoted(string text)
    {
        var quoted = new StringBuilder("\"");
        foreach (char c in text)
        {
            if (c < ' ' || c == '"' || c == '\\') quoted.AppendFormat("\\u{0:x4}", (int)c);
            else quoted.Append(c);
        }
        return quoted.Append('"').ToString();
    }

    private object Value()
    {
        char c = Next();
        if (c == '{') return Members();
        if (c == '[') return Items();
        if (c == '"') return Text();
        --at;
        int begin = at;
        while (at < text.Length && ",]} \n".IndexOf(text[at]) < 0) ++at;
        string word = text.Substring(begin, at - begin);
        if (word == "true" || word == "false") return word == "true";
        return word == "null" ? (object)null : double.Parse(word, CultureInfo.InvariantCulture);
    }

    private char Next()
    {
        while (" \n,:".IndexOf(text[at]) >= 0) ++at;
        return text[at++];
    }

    private Dictionary<string, object> Members()
    {
        var members = new Dictionary<string, object>();
        while (Next() != '}')
        {
            string name = Text();
            members[name] = Value();
        }
        return members;
    }

    private List<object> Items()
    {
        var items = new List<object>();
        while (Next() != ']')
        {
            --at;
            items.Add(Value());
        }
        return items;
    }

    // Reads a text from after its first quotation mark.
    private string Text()
    {
        var plain = new StringBuilder();
        for (char c = text[at++]; c != '"'; c = text[at++])
        {
            if (c == '\\') c = Escaped(text[at++]);
            plain.Append(c);
        }
        return plain.ToString();
    }

    private char Escaped(char c)
    {
        if (c != 'u') return c == 'n' ? '\n' : c == 't' ? '\t' : c == 'r' ? '\r' : c == 'b' ? '\b' : c == 'f' ? '\f' : c;
        at += 4;
        return (char)Convert.ToInt32(text.Substring(at - 4, 4), 16);
    }
}

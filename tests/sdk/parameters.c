/* Tests of include/gonio_parameters.h; ends with the number of failures told. */

#include "gonio_parameters.h"

#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

static void expect(int holds, const char *what, const char *text)
{
    if (!holds) {
        ++failures;
        printf("%s: %s\n", what, text);
    }
}

/* Bit for bit, so that -0 is not 0. */
static int same(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

static double number(const char *text)
{
    return gonio_number(text, "a", -7.0);
}

static void names_and_values(void)
{
    static const char all[] = " {\t\"alpha\" : 0.25 ,\n\"alpha_y\":2,\"a\":1e-3,\"m\\\"a\":5,"
                              "\"k\":\"a\\\"b\",\"empty\":\"\",\"a\\u00e9\\ud83d\\ude00\":6} ";
    expect(same(gonio_number(all, "alpha", 9.0), 0.25), "alpha", all);
    expect(same(gonio_number(all, "alpha_y", 9.0), 2.0), "a name that begins as another", all);
    expect(same(gonio_number(all, "a", 9.0), 1e-3), "a prefix of others", all);
    expect(same(gonio_number(all, "al", 9.0), 9.0), "a prefix that is not there", all);
    expect(same(gonio_number(all, "", 9.0), 9.0), "the empty name", all);
    expect(same(gonio_number(all, "m\"a", 9.0), 5.0), "a quote in a name", all);
    expect(same(gonio_number(all, "a\xc3\xa9\xf0\x9f\x98\x80", 9.0), 6.0), "escapes in a name", all);
    expect(same(gonio_number(all, "k", 9.0), 9.0), "a string is no number", all);
    expect(same(gonio_number(all, "b", 9.0), 9.0), "what is in a string is no name", all);
    expect(gonio_has(all, "k") && gonio_has(all, "a") && !gonio_has(all, "z"), "has", all);
    expect(gonio_is(all, "k", "a\"b") && !gonio_is(all, "k", "a") && !gonio_is(all, "k", "a\"bc"), "is", all);
    expect(gonio_is(all, "empty", "") && !gonio_is(all, "empty", "x"), "an empty string", all);
    expect(!gonio_is(all, "alpha", "0.25") && !gonio_is(all, "z", ""), "a number is no string", all);
    expect(same(number("{\"a\":1,\"a\":2}"), 2.0), "the last one counts", "");
    expect(same(number("{}"), -7.0) && same(number(NULL), -7.0), "nothing", "");
}

static void text(void)
{
    static const char all[] = "{\"n\":1,\"p\":\"C:\\\\x\\/\\b\\f\\n\\r\\t \\u20ac\",\"zero\":\"a\\u0000b\"}";
    static const char decoded[] = "C:\\x/\b\f\n\r\t \xe2\x82\xac";
    char room[64];
    expect(gonio_text(all, "p", room, sizeof room) && strcmp(room, decoded) == 0, "escapes", room);
    expect(gonio_text(all, "p", room, sizeof decoded) && strcmp(room, decoded) == 0, "just enough room", room);
    expect(!gonio_text(all, "p", room, sizeof decoded - 1) && room[0] == 0, "too little room", room);
    expect(!gonio_text(all, "p", room, 0), "no room", room);
    expect(!gonio_text(all, "n", room, sizeof room) && room[0] == 0, "a number", room);
    expect(!gonio_text(all, "q", room, sizeof room) && room[0] == 0, "not there", room);
    expect(!gonio_text(all, "zero", room, sizeof room) && room[0] == 0, "a zero within", room);
    expect(!gonio_is(all, "zero", "a"), "a zero is no end", all);
}

static void broken(void)
{
    static const char *const texts[] = {
        "", " ", "1", "[1]", "{", "{\"a\"", "{\"a\":", "{\"a\":1", "{\"a\":1,", "{\"a\":1,}", "{,\"a\":1}",
        "{\"a\":1}x", "{\"a\":1}{}", "{\"a\" 1}", "{a:1}", "{'a':1}", "{\"a\":1 \"b\":2}", "{\"a\":01}",
        "{\"a\":-}", "{\"a\":+1}", "{\"a\":.5}", "{\"a\":1.}", "{\"a\":1e}", "{\"a\":1e+}", "{\"a\":1x}",
        "{\"a\":0x10}", "{\"a\":1,5}", "{\"a\":nan}", "{\"a\":NaN}", "{\"a\":Infinity}", "{\"a\":true}",
        "{\"a\":null}", "{\"a\":[1]}", "{\"a\":{\"a\":1}}", "{\"a\":1,\"b\":{}}", "{\"a\":1,\"b\":\"c}",
        "{\"a\":1,\"b\":\"\\x\"}", "{\"a\":1,\"b\":\"\\u12\"}", "{\"a\":1,\"b\":\"\\ud800\"}",
        "{\"a\":1,\"b\":\"\\udc00\"}", "{\"a\":1,\"b\":\"\\ud800\\u0041\"}", "{\"a\":1,\"b\":\"\n\"}",
        "{\"a\":1,\"b\":\"\\", "{\"a\":1,\"b\":\"\\u", "{\"a\":1,\"b\":\"\\ud83d\\u",
    };
    size_t k;
    for (k = 0; k < sizeof texts / sizeof *texts; ++k) {
        expect(same(number(texts[k]), -7.0) && !gonio_has(texts[k], "a"), "broken, and read", texts[k]);
    }
}

/* As strtod reads it in the locale "C". */
static void as_strtod(const char *digits)
{
    char all[2048];
    sprintf(all, "{\"a\":%s}", digits);
    expect(same(number(all), strtod(digits, NULL)), "not as strtod", digits);
}

static unsigned long long next(void)
{
    static unsigned long long state = 88172645463325252ULL;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state;
}

static void numbers(void)
{
    static const char *const texts[] = {
        "0", "-0", "0.0", "-0e5", "1", "-1", "10", "100", "0.1", "0.3", "123456789012345678901234567890",
        "1e0", "1E+5", "1e-5", "1.5e3", "1e22", "1e23", "1e308", "1.7976931348623157e308",
        "1.7976931348623159e308", "1e309", "-1e400", "1e999999999999", "1e-999999999999", "0e999999999999",
        "2.2250738585072014e-308", "2.2250738585072011e-308", "2.225073858507201e-308", "5e-324", "2.4e-324",
        "2.5e-324", "2.4703282292062327e-324", "2.4703282292062328e-324", "1e-400", "9007199254740993",
        "9007199254740993.00000000000000000000000000000000000001", "9007199254740992.99999", "0.5",
        "0.99999999999999994", "0.999999999999999944488848768742172978818416595458984375", "4.35", "1e-4",
        "0.000000000000000000000000000000000000000000000000000001", "8.41e21", "9.5367431640625e-7",
        "0.30000000000000004", "3.14159265358979323846264338327950288419716939937510582097494459",
    };
    char digits[1200];
    size_t k;
    for (k = 0; k < sizeof texts / sizeof *texts; ++k) {
        as_strtod(texts[k]);
    }
    for (k = 0; k < 5000; ++k) {
        const unsigned long long bits = next();
        double x;
        memcpy(&x, &bits, sizeof x);
        if (x - x == 0.0) {
            sprintf(digits, "%.*g", 1 + (int)(next() % 20), x);
            as_strtod(digits);
        }
    }
    /* Halfway between two doubles, and next to it, in all 700 to 1000 digits. */
    for (k = 0; k < 50; ++k) {
        const long double x = (long double)(next() >> 11) + 0.5L;
        char *end = digits + sprintf(digits, "%.1080Lf", ldexpl(x, -1074 + (int)(next() % 20)));
        as_strtod(digits);
        end[-1] = '1';
        as_strtod(digits);
    }
    for (k = 0; k < 1000; ++k) {
        const unsigned long long half = 9007199254740993ULL + 2 * (next() >> 12);
        sprintf(digits, "%llu", half);
        as_strtod(digits);
        sprintf(digits, "%llu.000000000000000000000000000000001", half);
        as_strtod(digits);
    }
    memset(digits, '0', 1000);
    memcpy(digits, "9007199254740993.", 16);
    strcpy(digits + 1000, "1");
    as_strtod(digits);
}

int main(void)
{
    names_and_values();
    text();
    broken();
    numbers();
    /* Where there is a locale with a decimal comma, it changes nothing. */
    if (setlocale(LC_ALL, "de_DE.UTF-8") != NULL) {
        expect(same(number("{\"a\":0.25}"), 0.25), "a comma", "");
    }
    printf("%d failures\n", failures);
    return failures != 0;
}

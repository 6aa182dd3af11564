"""In which encoding a text is written that is not UTF-8: Western European or Chinese."""

from __future__ import annotations

import contextlib
import itertools
import re
from dataclasses import dataclass

_HIGH = re.compile(r"[^\x00-\x7f]+")
_LETTERS = re.compile(r"[^\W\x00-\x7f]+")

# What a sign costs: -log of how often it comes among those of its encoding, in heads of records.
_WESTERN = {
    **dict.fromkeys("ÄÖÜÉÈÀÇÑÁÍÓÚÅØÆêëâûùîïôãõœýþð¿¡±§–’×\xa0", 5.0),
    **dict.fromkeys("äöüßéèàçñáíóúåøæ°²³µ·", 3.4),
}
_LETTER, _CONTROL, _NONE = 7.5, 12.0, 20.0  # any other sign; a control sign; none at all
_BESIDE, _SIGNS = 3.5, 2.0  # a letter, a sign or the same letter right behind another high one
_CAPITAL = 3.0  # a capital behind a small letter
_ALONE = 2.5  # a word without an ASCII letter
_COMMON = frozenset(
    "的一是在不了有和人这中大为上个国我以要他时来用们生到作地于出就分对成会可主发年动同工也能下过"
    "子说产种面而方后多定行学法所民得经十三之进着等部度家电力里如水化高自二理起小物现实加量都两体"
    "制机当使点从业本去把性好应开它合还因由其些然前外天政四日那社义事平形相全表间样与关各重新线内"
    "数正心反你明看原又么利比或但质气第向道命此变条只没结解问意建月公无系军很情者最立代想已通并提"
    "直题党程展五果料象员革位入常文总次品式活设及管特件长求老头基资边流路级少图山统接知较将组见计"
    "别她手角期根论运农指几九区强放决西被干做必战先回则任取据处队南给色光门即保治北造百规热领七海"
    "口东导器压志世金增争济阶油思术极交受联什认六共权收证改清己美再采转更单风切打白教速花带安场身"
    "车例真务具万每目至达走积示议声报斗完类八离华名确才科张信马节话米整空元况今集温传土许步群广石"
    "记需段研界拉林律叫且究观越织装影算低持音众书布复容儿须际商非验连断深难近矿千周委素技备半办青"
    "省列习响约支般史感劳便团往酸历市克何除消构府称太准精值号率族维划选标写存候毛亲快效院查江型"
    "眼王按格养易置派层片始却专状育厂京识适属圆包火住调满县局照参红细引听该铁价严龙飞测振幅频谱"
    "轴承齿轮箱壳座轨啮位移速加转矩扭矩滤波采样通道输入输出电压流径垂竖横纵前后左右顶底侧脉冲键"
    "相噪源载荷负载序列编号备注单位秒毫微米克赫兹伏安瓦牛帕弧毂泵阀叶涡谐阈误差均峰谷有效峭斜偏"
    "直交互功密倒阶啸叫驱被主减箱行星太阳圈链索弹簧阻尼刚模态激励锤击靶盘试台架工况健康故障磨损"
    "镗铣刨钻刀杆蜗丝杠花套瓦垫片裂纹断剥落点蚀胶合不对中衡松外圈滚保温湿度润滑油液冷却"
    "，。：；、（）【】“”《》—…·℃㎡°±μ×％"
)
_USED, _FIRST, _SECOND = 6.0, 10.5, 12.5  # common; else of the first, second level of GB 2312
_MARKS, _ROWS, _FOUR, _RARE = 8.2, 11.5, 9.0, 17.0  # its signs; other rows; four bytes; others
_ASCII = 3.0  # each ASCII byte that a Chinese character takes to itself
_INSIDE = 3.0  # one Chinese character between two ASCII letters
_LONG, _DEAR = 4, 11.0  # letters in a row, and a mean cost, from which no reading is likely


@dataclass(frozen=True)
class Encoding:
    """An encoding: ``codec`` that reads it, ``name`` it is told by; ``likely``: its signs are such
    as heads hold."""

    codec: str
    name: str
    likely: bool = True


def encoding_of(head: bytes) -> Encoding:
    """The encoding of a text that is no UTF-8, by its first bytes.

    Windows-1252 (Latin-1 and more) or GB 18030 (GBK and more), whichever makes the signs that are
    not ASCII the more likely: European letters are single ones between ASCII letters, Chinese
    characters are pairs of high bytes, most of them of few hundred common ones.

    >>> encoding_of("Gehäuse [µm]".encode("latin-1")).name
    'Latin-1'
    >>> encoding_of("加速度 [g]".encode("gbk")).name
    'GBK'
    """
    european = head.decode("cp1252", "replace")
    dear = _as_european(european)
    with contextlib.suppress(UnicodeDecodeError):
        chinese = head.decode("gb18030")
        cost = _as_chinese(chinese)
        if cost < dear:
            return Encoding("gb18030", "GBK", cost <= _DEAR * sum(map(len, _HIGH.findall(chinese))))
    if "\ufffd" in european:
        return Encoding("latin-1", "Latin-1", likely=False)
    longest = max(map(len, _LETTERS.findall(european)), default=0)
    beyond = any(0x80 <= byte < 0xA0 for byte in head)
    return Encoding("cp1252", "Windows-1252" if beyond else "Latin-1", longest < _LONG)


def _as_european(text: str) -> float:
    """What the signs of a text cost that was read as Windows-1252."""
    cost = 0.0
    for found in _HIGH.finditer(text):
        run, before, after = found.group(), *_around(text, found)
        for last, sign in itertools.pairwise((before or " ") + run):
            cost += _european(sign) + _CAPITAL * (sign.isupper() and last.islower())
            if last > "\x7f":
                twice = last == sign and sign.isalpha()
                cost += _SIGNS if twice or last.isalpha() != sign.isalpha() else _BESIDE
        if len(run) > 1 and not (before.isalpha() or after.isalpha()):
            cost += _ALONE
    return cost


def _european(sign: str) -> float:
    if sign == "\ufffd":
        return _NONE
    return _WESTERN.get(sign, _CONTROL if "\x80" <= sign < "\xa0" else _LETTER)


def _as_chinese(text: str) -> float:
    """What the signs of a text cost that was read as GB 18030."""
    cost = 0.0
    for found in _HIGH.finditer(text):
        run, before, after = found.group(), *_around(text, found)
        cost += sum(map(_chinese, run))
        if len(run) == 1 and before.isalpha() and after.isalpha():
            cost += _INSIDE
    return cost


def _chinese(sign: str) -> float:
    if sign in _COMMON:
        return _USED
    raw = sign.encode("gb18030")
    if len(raw) == 4:
        return (_FOUR if sign < "\u0180" else _RARE) - 2.0 * _ASCII
    lead, trail = raw
    if trail < 0xA1:
        return _RARE - _ASCII * (trail < 0x80)
    if 0xB0 <= lead <= 0xF7:
        return _FIRST if lead <= 0xD7 else _SECOND
    if lead in (0xA1, 0xA2, 0xA3, 0xA6, 0xA8):
        return _MARKS
    return _ROWS if 0xA1 <= lead <= 0xA9 else _RARE


def _around(text: str, found: re.Match[str]) -> tuple[str, str]:
    """The signs right before and right behind what was ``found``; "" at an end."""
    return text[max(found.start() - 1, 0) : found.start()], text[found.end() : found.end() + 1]

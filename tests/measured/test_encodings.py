"""The encoding of a text that is no UTF-8: European heads are no Chinese ones, nor these those."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from thermogear.measured.encodings import encoding_of
from thermogear.measured.readers import read_record

EUROPEAN = {
    "German": (
        "Gehäuse Getriebegehäuse Größe Übersetzung Zähnezahl Öltemperatur Längsbeschleunigung "
        "Prüfstand Körperschall Führungsgröße Maßänderung Drehzahl_Rührer GRÖßE MESSGRÖSSE "
        "HÖHE Stoßimpuls gemäß Ölöffnung für über Äußere Phasenverhältnis Verzögerung"
    ),
    "French": (
        "Accélération vitesse_arrêt Fréquence déplacement phase_à_vide Créée engrenée Boîte "
        "Réducteur Vibré_côté Écart Énergie température Hélice dérivée mesurée Après "
        "préchargée FRÉQUENCE Tête cœur nœud Voie_n°1 Référence Générateur décélération"
    ),
    "Spanish": (
        "Aceleración Vibración Señal Señales Posición Tacómetro Año Número Índice Ángulo "
        "Montaña Análisis Revoluciones_por_año Frecuencia_máxima Engranaje_pequeño cigüeñal "
        "Útil ACELERACIÓN"
    ),
    "Scandinavian": (
        "Hjørne Måling Måned Växellåda Høyre Tørrkjøring Svängning Åtdragning Kåpa Øvre "
        "Nedre_øre Kjøreprøve Rörelse Tähtäin Kiihtyvyys_pää Værdi Målefrekvens Ölläge KÄÄNTÖ "
        "Länkåår ååå"
    ),
    "Italian and Portuguese": (
        "Velocità Qualità Aceleração Vibração Rotação Tensão Pressão Posição Unità Perché "
        "Oscilação à_saída"
    ),
    "Polish in letters that Latin-1 has": (
        "Obrót Przekrój Napór Ogólny Wirówka Skrót Czujnik_górny Krótki Wtórny Powrót"
    ),
}
UNITS = "m/s²;mm/s²;µm;°C;g;N·m;±5 g;kg·m²·s;1/m³;§3;mm²;°;m²/K"
CHINESE = (
    "时间 加速度 振动 转速 通道一 通道二 轴承座 齿轮箱 电机驱动端 输入轴 输出轴 径向 轴向 垂直 "
    "水平 温度 扭矩 电压 电流 位移 速度 频率 采样点 序号 幅值 相位 脉冲 键相 压力 流量 噪声 "
    "应变 载荷 啮合力 阈值 测点 传感器 箱体 太阳轮 行星架 内齿圈 高速级 低速级 前端 后端 上侧 "
    "左侧 右侧 底座 机壳 风机 水泵 主轴 刀具 镗杆 铣刀 锥齿 蜗杆 涡轮 叶片 谐波 倒频谱 均方根 "
    "峭度 包络 X轴 Y向 1号泵 A相 测点3 #2电机"
)
CHINESE_UNITS = "m/s2;g;℃;μm;mm/s;r/min;（g）;°;N·m"


def heads(text: str, symbols: str, seed: int) -> list[str]:
    """Each word alone with a unit, and lines of three at random over rows of numbers."""
    random, words, units = np.random.default_rng(seed), text.split(), symbols.split(";")
    single = [f"t;{word} [{unit}]\n0,1;2\n" for word, unit in zip(words, itertools.cycle(units))]
    drawn = [
        ";".join(f"{random.choice(words)} [{random.choice(units)}]" for _ in range(3))
        for _ in range(400)
    ]
    return single + [f"{line}\n0,0;1,5;2,5\n" for line in drawn]


@pytest.mark.parametrize("language", EUROPEAN)
def test_european_heads_are_never_read_as_chinese(language: str) -> None:
    for head in heads(EUROPEAN[language], UNITS, seed=len(language)):
        raw = head.encode("cp1252")
        if head.isascii():
            continue
        found = encoding_of(raw)
        assert found.name in ("Latin-1", "Windows-1252"), head
        assert (raw.decode(found.codec), found.likely) == (head, True)


def test_chinese_heads_are_never_read_as_european() -> None:
    for head in heads(CHINESE, CHINESE_UNITS, seed=7):
        for codec in ("gbk", "gb18030"):
            raw = head.encode(codec, "ignore")
            found = encoding_of(raw)
            assert (found.name, found.likely) == ("GBK", True), head
            assert raw.decode(found.codec) == raw.decode(codec)


def test_every_character_of_the_first_level_may_be_a_name_of_its_own() -> None:
    for lead, trail in itertools.product(range(0xB0, 0xD7), range(0xA1, 0xFF)):
        raw = bytes([lead, trail])
        assert encoding_of(raw + b" [g];" + raw + b"1 [g]\n0;1\n").name == "GBK", raw.decode("gbk")


def test_signs_of_gb_18030_with_four_bytes() -> None:
    raw = "加速度 (m/s²),Gehäuse [µm]".encode("gb18030")
    assert encoding_of(raw).name == "GBK"
    assert encoding_of("Gehäuse [µm]".encode("gb18030")).name == "GBK"


@pytest.mark.parametrize("codec", ["cp1251", "cp1253", "shift-jis"])
def test_letters_that_hardly_come_so_are_told(codec: str) -> None:
    words = {
        "cp1251": "Время [с];Ускорение корпуса [м/с2];Скорость",
        "cp1253": "Χρόνος;Επιτάχυνση;Ταχύτητα",
        "shift-jis": "時間;振動加速度;回転速度",
    }
    assert not encoding_of(words[codec].encode(codec)).likely


@pytest.mark.parametrize(
    ("head", "codec", "name", "unit"),
    [
        ("Zeit [s];Beschleunigung [m/s²]", "latin-1", "Beschleunigung", "m/s^2"),
        ("Zeit [s];Weg [µm]", "latin-1", "Weg", "um"),
        ("Zeit [s];Gehäuse – links [g]", "cp1252", "Gehäuse – links", "g"),
        ("temps [s];accélération [m/s²]", "latin-1", "accélération", "m/s^2"),
        ("时间 [s];加速度 [g]", "gbk", "加速度", "g"),
    ],
)
def test_names_and_units_are_read(
    tmp_path: Path, head: str, codec: str, name: str, unit: str
) -> None:
    path = tmp_path / "r.csv"
    body = "".join(f"{j / 1000:.4f};{j % 7}.5\n".replace(".", ",") for j in range(300))
    path.write_bytes((head + "\n" + body).encode(codec))
    record = read_record(path)
    assert (record.names, record.channels[0].unit) == ((name,), unit)
    assert record.rate == pytest.approx(1000.0)
    encoding = {"latin-1": "Latin-1", "cp1252": "Windows-1252", "gbk": "GBK"}[codec]
    told = [n.data for n in record.notices if n.code in ("text_not_utf_8", "text_doubtful")]
    assert told == [{"encoding": encoding}]
